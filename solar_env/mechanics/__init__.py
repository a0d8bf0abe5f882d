"""Planar multibody dynamics: mechanisms described as data, compiled into arrays, advanced by Numba kernels.

The package knows nothing of solar arrays, learning or drawing. Its subpackages, lowest first, import only from the ones
before them: `numerics`, `arrays`, `bodies`, `joints`, `mechanism`, `equations`, `records`, `modal`, `integrators`,
`running`, `analysis`.
"""
