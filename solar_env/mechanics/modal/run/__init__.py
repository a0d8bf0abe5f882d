"""Control of the steps of a run of modal panels: their size, events, books and samples.

Imports `step` and `records`. `driver` has the kernels of the method `ModalRadau`.
"""
