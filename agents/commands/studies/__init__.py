"""Studies of the pages on controllers: rows of `solar-env study`, as those of `solar_env.commands.studies`."""
