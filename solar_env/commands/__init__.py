"""Commands of ``python -m solar_env``: each module has ``add_arguments(parser)`` and ``run_command(args) -> int``."""
