"""Services of all rooms: files written whole, checks of names and values, many simulations at once, minimisation,
progress bars, tables in a terminal, and the README pages.

Imports nothing else of the package. A new module is about running or reporting, not about mechanics.
"""
