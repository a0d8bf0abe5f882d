"""Services for all packages: atomic writing of files, checks of names and values, parallel simulations, minimisation,
progress bars, tables in a terminal, and README pages.

These modules import nothing else from `solar_env`, and contain no mechanics.
"""
