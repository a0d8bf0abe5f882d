"""Studies of the pages on controllers: rows of `solar-env study`, as in `solar_env.commands.studies`."""
