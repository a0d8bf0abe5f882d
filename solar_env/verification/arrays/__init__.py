"""Verification cases of whole solar arrays: latch times, conservation, impacts, flexible and rigid panels.

Cases may use theory in `beams`, `linkages` and `impacts`. A new case is a generator of `Check`, added to `suite.CASES`.
"""
