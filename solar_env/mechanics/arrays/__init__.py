"""Model and state arrays in the layout that kernels read, for one mechanism or for a batch of mechanisms.

The package imports `numerics`. To add a joint quantity, add a field to a joint record type in `model`. The record types
of bodies and markers are defined in `bodies`.
"""
