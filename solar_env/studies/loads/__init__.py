"""How hard the hinges of an array and its hub are hit, and how sure that is.

`runs` simulates a deployment with samples fine enough for shocks, `quantities` says what is read from it,
`shock_spectrum` computes response spectra, `hub` the motion of the main body and the loads on it; `ensemble` runs many
members at two levels of the model, `statistics` turns them into figures with as many digits as they have, `report`
prints them and writes them as one page of HTML. Imports `common`. A further quantity is a row of
`quantities.QUANTITIES`.
"""
