"""Comparison of controllers, given by name, on the same episodes: statistics, tables and plots.

This package imports the laws and run folders. A new quantity in the tables is an entry of `report.TABLE`; a new kind of
controller is a branch of `controllers.NamedController`.
"""
