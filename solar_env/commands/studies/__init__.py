"""Studies on the documentation pages, which `solar-env study` runs; each is a module with `OPTIONS` and `run(args)`."""
