"""Views of an episode: `film` draws frames, `window` shows them, `recording` keeps motions for plots and pages.

Imports `solar_env.pictures`, the engine, and the settings of an environment; no rewards, no episodes.
"""
