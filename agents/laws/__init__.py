"""Torque laws: controllers without learning.

To add a law, write a subclass of `TunableLaw` in a new file here. Its parameters are a dataclass derived from
`LawParameters`, each declared with default and range. Add the law to `agents.laws.table`, and run `solar-env tune
--controller NAME` to find its parameters. The tests cover all laws in the table.
"""
