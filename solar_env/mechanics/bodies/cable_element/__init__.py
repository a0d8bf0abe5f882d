"""Beams of cable elements in absolute nodal coordinates: a kind of flexible body.

`element` is the kind, with mass and markers; `matrices` are those of an element, `forces` its internal forces,
`tangent` their slopes, and `stable_step` the longest step of explicit methods. Imports descriptions and markers of the
room around it.
"""
