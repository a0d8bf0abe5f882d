"""Parts that the studies share: scenes and motions, levels, measures of error, sampling bands, timing, tables, drawing.

Imports the engine, the array and the pictures, and no study. Add what a second study needs.
"""
