"""Kinds of bodies: coordinates, mass, forces, slopes, energies, and the bound of a stable explicit step.

Imports `arrays` and `numerics`, and no joint. A kind of body is one file and one row of the table of kinds.
"""
