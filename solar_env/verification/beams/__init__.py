"""Cases of flexible bodies: element, statics, vibration and dynamics against beam theory.

Imports no other subject of the verification. A new case is a generator of `Check` and a row of `CASES`.
"""
