"""Planar multibody dynamics: mechanisms described as data, compiled into arrays, advanced by Numba kernels.

The package knows nothing of solar arrays, learning or drawing. Its rooms, lowest first, each importing only those
before it: `numerics`, `arrays`, `bodies` and `joints`, `mechanism`, `equations`, `records`, `modal`, `integrators`,
`running`, `analysis`.
"""
