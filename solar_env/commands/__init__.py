"""Commands of `solar-env`: each module has a documented dataclass `Args` and `run_command(args) -> int`.

Commands are thin: they read options, call a study or a simulation, and print. A ValueError, SimulationError or OSError
of `run_command` ends the process with its message and status 2. Commands may import everything in the package, but
modules that need the compiler only on running, so that `--help` is quick. A new command is a module here and a row of
`[project.entry-points."solar_env.commands"]` in pyproject.toml; the first sentence of `Args` is its line in the help.
Rows of `solar-env study` are in `studies`.
"""
