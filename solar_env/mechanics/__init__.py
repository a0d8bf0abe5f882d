"""Planar multibody dynamics: mechanisms described as data, compiled into arrays, advanced by Numba kernels.

The package knows nothing of solar arrays or of learning. Its layers, lowest first:

``_jit`` -> ``model`` -> (``contact``, ``wear``, ``rigid``, ``joint``) -> (``system``, ``tangent``) ->
``integrators`` -> ``accuracy`` -> ``simulation``; ``description`` and ``build`` turn a mechanism into the arrays of
``model``.
"""
