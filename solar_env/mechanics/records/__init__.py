"""Memory of a run, whatever its method: samples and contacts, latches, wear and peak forces.

Imports the equations and the rooms below them. `recording` has the tables that a caller asks for, `history` the books
of accepted steps.
"""
