"""Cases of the pendulum, of the four-bar linkage and of a single hinge.

They import no other subject of the verification. A new case is a generator of `Check`, added to `suite.CASES`.
"""
