"""A step of the two-stage Radau IIA method: its unknown loads, their equations, Newton's iteration, and its acceptance.

Imports `panel`, the arrays of the mechanism, and the laws of the joints. `bodies` and `motion` go from loads to motion,
`rows` from unknown to unknown, `equations` from motion to loads; `solve` iterates and `acceptance` judges.
"""
