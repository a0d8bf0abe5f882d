"""Kinds of body: coordinates, mass, internal forces and markers. Each kind has its own file or folder.

A marker is a point of a body with a direction; both are linear in the body's coordinates. Each marker gives position
and direction with their rates, and receives a force and a torque. Code outside this package does not know the meaning
of a body's coordinates. The package imports `numerics` and `arrays` only.

To add a kind, write a parameter class in `description.py`, a file with a `BodyKind` and its kernels, an entry in
`kinds.KINDS`, and branches in `dispatch.py`. `tests/mechanics/bodies/test_kinds.py` then tests the kind.
"""
