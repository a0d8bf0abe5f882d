"""Verification of the simulation engine by cases whose answers are known from theory or literature.

A case yields checks. A check is a number from the engine beside its expected value. Expected values share no code with
the engine: they are closed forms, quadratures, or other formulations of the same mechanism that SciPy integrates. Long
derivations are in modules named `theory` or `*_theory`. A tolerance follows from the number of digits that a source
gives, or from the tolerance and order of an integrator.

Each folder holds the cases of one subject. `impacts`, `linkages` and `beams` do not import each other; `arrays` and
`panels` may use their theory modules. To add a case, write a generator of `Check` and add it to `CASES` in `suite`.
"""
