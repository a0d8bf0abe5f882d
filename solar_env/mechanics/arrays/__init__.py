"""Arrays of a model and of its state, in the layout that kernels read, for one mechanism or many side by side.

Imports `numerics`. A new quantity of a joint or body is a field of its record type in `model`.
"""
