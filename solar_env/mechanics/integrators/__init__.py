"""Time integration: one run loop controls steps, ends steps at events and records samples for all `methods`.

`settings` defines the integrators that a user chooses from, in plain Python. `formulations` is the table of
formulations. `run` advances mechanisms step by step, and `events` locates events inside a step. The package imports
`records`, `equations` and `modal`, which provides one of the methods.
"""
