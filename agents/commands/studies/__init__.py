"""Commands of `solar-env study` that make the pages on controllers, as in `solar_env.commands.studies`."""
