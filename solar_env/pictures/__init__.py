"""Frames of the environment, and figures and pages of a deployment, drawn from plain data.

`frame` draws one instant, `films` writes films, `plots` draws the figure of a trajectory, `page` writes pages that
move; `style` holds colours, markers and the style sheet of all figures.

Imports `support`, and of `mechanics` the type of a trajectory alone. A new figure takes its colours and its style from
`style`.
"""
