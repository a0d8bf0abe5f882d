"""Studies of the pages: rows of `solar-env study`, each a module with `OPTIONS` and `run(args)`."""
