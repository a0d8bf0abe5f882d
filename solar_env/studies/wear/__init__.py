"""Deployments repeated with the worn clearance fed back.

`repeated` measures them, `plot` draws them. Imports `common`.
"""
