"""Analyses of a mechanism: static equilibria, linearization, natural frequencies, and centrelines for drawing.

The package imports packages listed before it in `mechanics/__init__.py`. To add an analysis, add a module of functions.
"""
