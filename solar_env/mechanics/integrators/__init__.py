"""Time integration: one loop that controls steps, lands on events and records; the methods are in `methods`.

`settings` has the integrators that a user chooses from, in plain Python; `formulations` is the table of formulations;
`run` advances lanes step by step, with `events`. Imports `modal`, whose method is one of the table, `records` and the
equations.
"""
