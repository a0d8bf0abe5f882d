"""Comparison of controllers: naming them, running the same episodes for all, statistics, tables and figures.

Imports the laws, run folders and shipped policies. To add a suite: an entry of `SUITES` in `evaluation`; a
figure of an episode: a row in `report.TABLE`; a kind of controller: a subclass of `controllers.NamedController` that
`parse_controller` chooses.
"""
