"""The equations of motion of a mechanism: assembly, accelerations, constraints, energies, tangents, elimination.

Imports the descriptions and the parts' forces. What a kind of body or a law adds is in its file:
nothing here asks which one it is.
"""
