"""Another program on the same scenes: Exudyn with another model.

Imports `common`; Exudyn only when it runs. A further program is a module with a function from a scene to a motion,
and a row of `METHODS` in `solar_env.studies.precision.methods`.
"""
