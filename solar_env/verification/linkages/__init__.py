"""Verification cases of the pendulum, of the four-bar linkage and of a single hinge.

These modules import no other folder of the verification. A new case is a generator of `Check`, added to `suite.CASES`.
"""
