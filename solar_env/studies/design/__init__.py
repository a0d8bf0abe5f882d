"""Design studies of an array: a grid over one or two parameters, or a search over several, by quantities of `loads`.

`plan` states the question, `points` simulates designs at a sufficient model level, `search` finds the best design, and
`plot` draws the designs. Imports `loads` and `common`.
"""
