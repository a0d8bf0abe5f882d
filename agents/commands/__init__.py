"""Thin commands on controllers, a module each: `solar-env train`, `tune`, `evaluate`, `compare`, `replay`, `export`.

Imports all other rooms; no room imports this one. A new command is a module with `Args` and `run_command` and a row in
pyproject.toml, see `solar_env.commands`. Rows of `solar-env study` are in `studies`.
"""
