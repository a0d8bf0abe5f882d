"""Cases of pendulums, chains and closed linkages against Newton-Euler formulations and published figures.

Imports no other subject of the verification. A new case is a generator of `Check` and a row of `CASES`.
"""
