"""Records of a run by any integration method: samples and contacts, latches, wear and peak forces.

The package imports `equations` and the packages below it. `recording` has the tables that a caller requests; `history`
updates contacts, latches, wear and peak forces on accepted steps.
"""
