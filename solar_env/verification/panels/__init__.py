"""Verification cases of modal panels and their integration method: step responses, deflections, impacts, large motions.

These modules may use the theory in `beams`; no other folder imports them.
A new case is a generator of `Check`, added to `suite.CASES`.
"""
