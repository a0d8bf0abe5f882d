"""Beams of cable elements in absolute nodal coordinates: a kind of flexible body.

`element` is the kind, with mass and markers; `matrices` are those of a straight beam, `forces` its internal forces,
and `tangent` their slopes. Imports descriptions and markers of the room around it.
"""
