"""Design studies of an array: maps of one or two parameters, and a search of several, by the figures of `loads`.

`plan` states the question, `points` measures designs at the level that answers it, `search` finds the best design,
`plot` draws the designs. Imports `loads` and `common`.
"""
