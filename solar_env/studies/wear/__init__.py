"""Repeated deployments, in which wear enlarges the clearances of later deployments.

`repeated` simulates the deployments and tabulates them, `plot` draws a figure from the table. Imports `common`.
"""
