"""Views of an episode: `film` draws frames, `window` shows frames, `recording` keeps trajectories for plots and pages.

The package imports `solar_env.pictures`, `array`, `mechanics` and `environment.settings`, but not `episodes`.
"""
