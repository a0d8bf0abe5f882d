"""Cases of the pendulum and of the four-bar linkage.

Imports no other subject of the verification. A new case is a generator of `Check` and a row of `CASES`.
"""
