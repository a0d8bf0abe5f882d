"""Beams of cable elements in absolute nodal coordinates: a kind of flexible body.

`element` defines the kind, with its mass and markers. `matrices` has the matrices of a straight beam, `forces` the
internal forces, and `tangent` the forces' derivatives. The package imports `description` and `kind` from `bodies`.
"""
