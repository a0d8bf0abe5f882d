"""Torque laws: controllers without learning.

To add a law: write its class in a new file here, as a `TunableLaw` with a dataclass of `LawParameters`, each
with its default and range; add a row to `agents.laws.table`; run `solar-env tune --controller NAME` to find its
parameters. The tests run over the table.
"""
