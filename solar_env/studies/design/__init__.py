"""Design studies of an array: a grid over one or two parameters, or a search over several.

Designs are judged by the quantities that the study `loads` computes. `plan` states the question, `points` simulates
designs at a sufficient model level, `search` finds the best one, `plot` draws them. Imports `loads` and `common`.
"""
