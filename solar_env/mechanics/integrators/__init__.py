"""Time integration: one loop that controls steps, lands on events and records; the methods are in `methods`.

`settings` has what a user chooses, in plain Python; `formulations` is the table of what models and states consist of;
`run` advances lanes step by step, with `events`. Imports `modal`, whose method is one of the table, `records` and the
equations.
"""
