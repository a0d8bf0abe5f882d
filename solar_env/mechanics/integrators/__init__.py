"""Time integration: a driver that controls steps, locates events and records; the methods are in `methods`.

`settings` has what a user chooses, in plain Python; `driver` runs a call and its lanes; `adaptive` takes steps that
land on events, with `acceptance` and `events`; `step` has the arrays of a step; `history` and `recording` keep what
happened to a mechanism and what a run records. Imports the equations and what lies below them.
"""
