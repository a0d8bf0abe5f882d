"""Maps of where methods fail: small runs with a known answer, each failure with a sentence of advice.

Imports `common`. A map is a module with cells and a measurement, and a row of `MAPS` in `stability_maps`.
"""
