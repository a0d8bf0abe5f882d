"""Cases of single contacts: impact, sliding, wear, and the stops of joints, against closed forms.

Imports no other subject of the verification. A new case is a generator of `Check` and a row of `CASES`.
"""
