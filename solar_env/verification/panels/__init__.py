"""Cases of modal panels: step responses, deflections, impacts and large motions, and the method that integrates panels.

These cases may use the theory in `beams`; no other subject imports them.
A new case is a generator of `Check`, added to `suite.CASES`.
"""
