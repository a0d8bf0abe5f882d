"""Memory of a run, whatever its method: samples and contacts, latches, wear and peak forces.

Imports the equations and what lies below them. `recording` has the tables that a caller asks for, `history` what is
booked on accepted steps.
"""
