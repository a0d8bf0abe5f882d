"""Studies of controllers, which `solar-env study` runs: modules with `OPTIONS` (names of options) and `run(args)`."""
