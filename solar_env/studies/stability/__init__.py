"""Stability maps: where numerical methods fail in small runs with known answers, with advice for each failure.

Imports `common`. To add a map, define a `StabilityMap` in a module, and add the map to `ALL` in `stability_maps`.
"""
