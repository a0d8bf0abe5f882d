"""Compilation of kernels, and tools for all kernels: linear algebra, vectors, and control of step sizes.

The package imports no other part of `mechanics`. Every kernel is decorated with `jit.kernel`, whose cache depends on
all files that the kernel's module imports.
"""
