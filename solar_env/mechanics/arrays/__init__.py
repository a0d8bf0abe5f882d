"""Arrays that kernels work on: the constant model, the state, status codes; many mechanisms side by side.

The room imports `numerics` only. The rows of bodies and markers are made in `bodies`, where the kinds of body are.
"""
