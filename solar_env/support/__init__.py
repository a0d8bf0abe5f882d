"""Services of commands and studies: many simulations at once, progress bars, and the README pages.

Imports nothing else of the package. A new module is about running or reporting, not about mechanics.
"""
