"""Analyses of a mechanism: static equilibria, linearization, natural frequencies, and centrelines for drawing.

The package imports `running` and the packages below. A new analysis is a module of functions of a mechanism or a model.
"""
