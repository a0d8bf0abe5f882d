"""Modal panels as the run loop meets them: `method` has the kernels of `ModalRadau`, with books and samples.

Imports `step` and `records`.
"""
