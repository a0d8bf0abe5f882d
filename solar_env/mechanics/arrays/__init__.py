"""Arrays of a model and of its state, in the layout that kernels read, for one mechanism or many side by side.

Imports `numerics`. A new quantity of a joint is a field of its record type in `model`; the rows of bodies and markers
are made in `bodies`, where the kinds of body are.
"""
