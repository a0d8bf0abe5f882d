"""Repeated deployments, in which wear enlarges the clearances of later deployments.

`repeated` measures the deployments, `plot` draws their table. Imports `common`.
"""
