"""Loads on the hinges and the hub of an array, with their uncertainty.

`runs` simulates a deployment with samples fine enough for shocks, and `quantities` reads figures from it.
`shock_spectrum` computes response spectra, `hub` the motion of the main body and the loads on it. `ensemble` runs many
members at two levels of the model, and `statistics` turns the runs into figures with as many digits as are certain.
`report` states the figures in lines and tables, `page` shows them on one page. Imports `common`. A further quantity
is a row of `quantities.QUANTITIES`.
"""
