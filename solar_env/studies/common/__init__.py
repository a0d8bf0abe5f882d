"""Parts that the studies share: scenes and motions with their errors, levels, sampling bands, timing, tables, drawing.

Imports the engine, the array and the pictures, but no study. Code moves here when a second study needs it.
"""
