"""Equations of motion of a whole mechanism: its arrays, forces, accelerations, constraints, slopes, Newton's matrix.

The room sums up what bodies and joints offer; it imports all rooms of `mechanics` but `integrators`, `running` and
`analysis`.
"""
