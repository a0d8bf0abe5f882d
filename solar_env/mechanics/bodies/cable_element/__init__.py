"""Beams of cable elements in absolute nodal coordinates: a kind of flexible body.

`element` is the kind, with mass and markers; `matrices` has a straight beam's matrices, `forces` the internal forces,
and `tangent` their slopes. Imports descriptions and markers of the room around it.
"""
