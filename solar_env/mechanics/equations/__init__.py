"""The equations of motion of a mechanism: assembly, accelerations, constraints, energies, tangents, elimination.

The package imports the mechanism description, and takes the forces of bodies and joints from `bodies` and `joints`.
"""
