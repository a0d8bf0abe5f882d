"""Cases of beam elements against beam theory: order of convergence, statics, vibration and dynamics.

They import no other subject of the verification. A new case is a generator of `Check`, added to `suite.CASES`.
"""
