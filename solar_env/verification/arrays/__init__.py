"""Cases of whole solar arrays: latch times, conservation, impacts within a deployment, flexible against rigid panels.

May use the theory in `beams`, `linkages` and `impacts`. A new case is a generator of `Check` and a row of `CASES`.
"""
