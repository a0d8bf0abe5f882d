"""Commands on controllers, thin, one module a command: `solar-env train`, `tune`, `evaluate`, `replay`, `export`.

Imports all other rooms; none imports this one. A new command is a module with `Args` and `run_command` and a row in
pyproject.toml, see `solar_env.commands`. Rows of `solar-env study` are in `studies`.
"""
