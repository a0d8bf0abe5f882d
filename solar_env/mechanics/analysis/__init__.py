"""Analyses of a mechanism at rest: equilibria, linearisation, natural frequencies, shapes for drawing.

Imports `equations` and `running`. A new analysis is a module with plain functions of a simulation or a model.
"""
