"""Comparison of controllers, given by name, on the same episodes: statistics, tables and plots.

This package imports `agents.laws` (torque laws) and `agents.learning` (trained policies in run folders). A new quantity
in the tables is an entry of `report.TABLE`; a new kind of controller is a branch of `controllers.NamedController`.
"""
