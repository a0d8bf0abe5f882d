"""Comparison of controllers by name on the same episodes: statistics, tables and figures.

This package imports the laws and run folders. A further figure of an episode is an entry of `report.TABLE`; a further
kind of controller is a branch of `controllers.NamedController`.
"""
