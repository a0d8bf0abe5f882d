"""Other programs (peers) that simulate the studies' deployments for comparison: Exudyn, with its model of the array.

Imports `common`, and Exudyn only when Exudyn runs. To add a program, write a module with a function from a `Scene` to a
`Motion`, and add a row to `METHODS` in `solar_env.studies.precision.methods`.
"""
