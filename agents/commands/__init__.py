"""Commands on controllers, thin, one module a command: `solar-env train`, `tune`, `evaluate` and others.

Imports all other rooms; none imports this one. Those that show an episode are in `showing`. A new command is a module
with `Args` and `run_command`, as in `solar_env/commands`, and a row of `COMMANDS` in `solar_env/__main__.py`, which
loads it, shows its help, and turns refused input, failed runs and Ctrl-C into one sentence and an exit status.
`arguments` has shared options.
"""
