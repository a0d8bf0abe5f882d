"""Thin command modules on controllers: `solar-env train`, `tune`, `evaluate`, `compare`, `replay`, `export`.

This package imports all other packages of `agents`, which never import it. A new command is a module with `Args` and
`run_command`, and an entry in pyproject.toml, see `solar_env.commands`. `studies` holds commands of `solar-env study`.
"""
