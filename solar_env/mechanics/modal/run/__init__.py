"""What a run of modal panels adds to its steps: their size, events, books and samples.

Imports `step` and `records`. `driver` has the kernels of the method `ModalRadau`.
"""
