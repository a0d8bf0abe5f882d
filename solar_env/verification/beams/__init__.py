"""Verification cases that compare beam elements with theory: order of convergence, statics, vibration and dynamics.

These modules import no other folder of the verification. A new case is a generator of `Check`, added to `suite.CASES`.
"""
