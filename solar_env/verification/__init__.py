"""Verification of the engine: cases whose answers are known from theory or literature.

A case yields checks: a number from the engine beside its expected value. Expected values share no code with the
engine. They are closed forms, quadratures, or other formulations of the same mechanism integrated by SciPy; the
longer ones stand in modules named `*_theory`. Tolerances follow from the digits of a source, or from an integrator's
tolerance and order.

Cases lie in the folder of their subject: `impacts`, `linkages` and `beams` know nothing of each other, `arrays` and
`panels` may use their theory. They import `array` and `mechanics`. A new case is a generator of `Check`
and a row of `CASES` in `suite`.
"""
