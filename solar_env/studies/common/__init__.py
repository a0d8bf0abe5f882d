"""Parts that the studies share: deployments to simulate and their records, model levels, timing, tables and plots.

Imports the engine, the array and the pictures, but no study. Code moves here when a second study needs it.
"""
