"""Cases of single contacts against closed forms: impact, sliding, wear, and the stops of joints.

They import no other subject of the verification. A new case is a generator of `Check`, added to `suite.CASES`.
"""
