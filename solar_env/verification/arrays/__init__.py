"""Verification cases of whole arrays: latch times, conservation, impacts in a deployment, flexible and rigid panels.

They may use theory in `beams`, `linkages` and `impacts`. A new case is a generator of `Check`, added to `suite.CASES`.
"""
