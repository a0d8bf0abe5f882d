"""Speed against accuracy of all methods and panels: work and precision, ensembles, levels, growth, side by side.

Imports `common` and `peers`. A method is a row of `METHODS` in `methods`, a study of them a row of `STUDIES` in
`charts`.
"""
