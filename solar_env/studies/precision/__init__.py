"""Speed against accuracy: work and precision of all methods, convergence of panel models, comparison with Exudyn.

Imports `common` and `peers`. To add a method, add a row to `METHODS` in `methods`. To add a study of the methods, add a
row to `STUDIES` in `charts`.
"""
