"""Speed against accuracy: work and precision of all methods, convergence of the panels, side by side with the peers.

Imports `common` and `peers`. A method is a row of `METHODS` in `methods`, a study of them a row of `STUDIES` in
`charts`.
"""
