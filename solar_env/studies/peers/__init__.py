"""Peer programs that simulate the studies' scenes for comparison: Exudyn, with its own model of the array.

Imports `common`, and Exudyn only when Exudyn runs. To add a program, write a module with a function from a scene to a
motion, and add a row to `METHODS` in `solar_env.studies.precision.methods`.
"""
