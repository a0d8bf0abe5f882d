"""Loads on the hinges and the hub of an array, with their uncertainty.

`runs` simulates a deployment with samples fine enough for shocks, and `quantities` computes quantities from it.
`shock_spectrum` computes response spectra, `hub` the motion of the main body and the loads on it. `ensemble` simulates
many members at two model levels, and `statistics` turns the runs into statistics with as many digits as are certain.
`report` states these in lines and tables, `page` shows them on one page. Imports `common`. To add a quantity, add a row
to `JOINT_QUANTITIES` or `HUB_QUANTITIES`.
"""
