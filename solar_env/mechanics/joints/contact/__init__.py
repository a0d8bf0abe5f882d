"""Normal contact of a journal in its bearing: the laws, one file each, and the table of them.

To add a law, write a file with a function from `Surfaces` and a coefficient of restitution to a law object, and a row
of the table in `laws.py`. If its force is no `PowerLaw`, write the object in that file too: a frozen dataclass with a
code of its own that checks its parameters, with the static methods `force`, `energy` and `impact_scales` of them, which
Numba can compile; and add the code to the dispatch in `normal_force.py`. Nothing else knows a law's form.
"""
