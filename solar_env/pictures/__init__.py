"""Frames of the environment, and figures and pages of a deployment, drawn from plain data.

`frame` draws one instant, `films` writes films, `plots` draws the figure of a trajectory, `page` writes animated pages
in HTML, and `style` holds colours, markers and the style sheet of all figures.

This package imports `support`, and from `mechanics` only the type of a trajectory. A new figure takes its colours and
its style from `style`.
"""
