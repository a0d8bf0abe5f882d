"""Cases of modal panels: their modes, responses, impacts, large motions, and the method that moves them.

May use the theory of `beams`; other subjects do not import this one. A new case is a generator of `Check` and a row of
`CASES`.
"""
