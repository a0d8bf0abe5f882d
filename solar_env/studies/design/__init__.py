"""What to change in an array: maps of one or two parameters, and a search of several, by the figures of `loads`.

`plan` says what is asked, `points` measures designs at the level that answers it, `search` finds the best one, `plot`
draws them. Imports `loads` and `common`.
"""
