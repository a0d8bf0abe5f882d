"""Commands that measure a study of `solar_env.studies`, and draw it from what was measured; as those of `commands`."""
