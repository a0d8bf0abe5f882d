"""Verification cases that compare single contacts with closed forms: impact, sliding, wear, and stops of joints.

These modules import no other folder of the verification. A new case is a generator of `Check`, added to `suite.CASES`.
"""
