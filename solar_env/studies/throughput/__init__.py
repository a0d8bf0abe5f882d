"""Environment steps per second, and the parts of their time.

Imports `common` and the environments. A further measurement is a function in `measurements`, and a column of
`as_markdown`.
"""
