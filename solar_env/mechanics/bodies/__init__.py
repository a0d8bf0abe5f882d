"""Kinds of body: coordinates, mass, internal forces and markers, one file or folder a kind.

A marker is a point of a body with a direction, both linear in the body's coordinates. A body offers at each of its
markers place and direction with their rates, and takes a force and a torque there; nothing outside this room knows a
body's coordinates. The room imports `numerics` and `arrays` only.

To add a kind: a class of parameters in `description.py`, a file with a `BodyKind` and its kernels, a row of `KINDS` in
`kinds.py`, and its branches in `dispatch.py`. `tests/mechanics/bodies/test_kinds.py` then tests it.
"""
