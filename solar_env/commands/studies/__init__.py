"""Studies behind the documentation pages. `solar-env study` runs these modules, each with `OPTIONS` and `run(args)`."""
