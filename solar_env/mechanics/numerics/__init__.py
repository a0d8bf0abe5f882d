"""Compilation of kernels, and what all of them may use: linear algebra, and the control of step sizes.

Imports nothing else of the package. Every kernel in the engine is decorated with `jit.kernel`, whose options say what
a caller must know; its cache is keyed by all that the kernel's module imports.
"""
