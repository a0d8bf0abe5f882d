"""Time integration: a driver that controls steps, locates events and records; the methods are in `methods`.

`settings` has what a user chooses, in plain Python; `formulations` is the table of what models and states consist of;
`driver` runs a call and its lanes; `adaptive` takes steps that land on events, with `acceptance` and `events`; `step`
has the arrays of a step. Imports `modal`, whose method is one of the table, `records` and the equations.
"""
