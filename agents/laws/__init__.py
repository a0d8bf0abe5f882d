"""Torque laws: controllers without learning.

To add a law, write its class in a new file here, as a `TunableLaw` with a dataclass of `LawParameters`, each
with its default and range. Add the law to `agents.laws.table`, and run `solar-env tune --controller NAME` to find its
parameters. The tests run over the table.
"""
