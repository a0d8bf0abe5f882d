"""Maps of the failures of methods: small runs with a known answer, and a sentence of advice for the failures.

Imports `common`. A map is a module with cells and a measurement, and a row of `MAPS` in `stability_maps`.
"""
