"""Environment steps per second, and what they are spent on.

Imports `common` and the environments. A further measurement is a function in `measurements`, and a column of
`as_markdown`.
"""
