"""Time integration: one run loop controls steps, ends steps at events and records samples for all `methods`.

`settings` defines the integrators that a user chooses from, in plain Python. `formulations` lists two formulations of
the equations of motion: absolute coordinates, floating frames. `run` advances mechanisms step by step, and `events`
locates events in a step. The package imports packages `records`, `equations` and `modal`, which provides one method.
"""
