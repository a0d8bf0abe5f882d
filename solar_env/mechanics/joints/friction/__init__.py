"""Friction of a journal in its bearing: the laws, one file each, and the table of them.

To add a law, write a file with a frozen dataclass that has a code of its own, checks its parameters and has the static
method `share` of these and of the sliding speed, which Numba can compile, and a function that makes it; add a row to
the table in `laws.py` and the code to the dispatch in `friction_share.py`.
"""
