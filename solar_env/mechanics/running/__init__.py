"""Simulations of mechanisms, batches of them on all cores, trajectories, accuracy, diagnosis and errors.

The package imports `integrators` and the packages below it. A new result of a run becomes a property of `Trajectory`, a
new warning a function of `diagnosis`.
"""
