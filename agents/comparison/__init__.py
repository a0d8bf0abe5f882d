"""Comparison of controllers: naming them, running the same episodes for all, statistics, tables and figures.

Imports the laws and run folders. To add a figure of an episode: a row in `report.TABLE`; a kind of controller: a branch
of `controllers.NamedController`.
"""
