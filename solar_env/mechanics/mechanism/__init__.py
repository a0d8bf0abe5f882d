"""Mechanisms as data: bodies, joints, springs, stops, bearings, cables, drives and loads.

`description` holds the parts, `textbook` and `beams` build mechanisms of the literature from them. Imports the rooms
below. A new part is a frozen dataclass in SI units, checked when it is made, and its place in `equations.build`.
"""
