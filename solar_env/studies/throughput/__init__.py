"""Environment steps per second, where their time goes, memory and start-up.

Imports `common` and the environments. A further measurement is a row of what `measurements` returns, and a column of
`tables`.
"""
