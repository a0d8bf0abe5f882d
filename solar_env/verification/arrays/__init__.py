"""Cases of whole solar arrays: latch times, conservation, impacts within a deployment, flexible against rigid panels.

They may use theory in `beams`, `linkages` and `impacts`. A new case is a generator of `Check`, added to `suite.CASES`.
"""
