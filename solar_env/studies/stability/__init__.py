"""Maps of where numerical methods fail, from small runs with known answers, with advice for each failure.

Imports `common`. A map is a module with cells and a measurement, and a row of `MAPS` in `stability_maps`.
"""
