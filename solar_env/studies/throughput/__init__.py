"""Throughput of the environments: steps per second, and the fraction of the time in compiled calls.

Imports `common` and the environments. To add a measurement, add a function to `measurements` and a column to
`as_markdown`.
"""
