"""Parts that the studies share: scenes and motions with their errors, levels, sampling bands, timing, tables, drawing.

Imports the engine, the array and the pictures, and no study. Add what a second study needs.
"""
