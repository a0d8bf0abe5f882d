"""Frames of the environment and figures of a deployment, drawn from plain data.

`scene` describes one instant, `raster` holds canvas, text and layout, `views` the parts of a frame, `render` the whole
frame, `gif` writes films; `plots` draws figures of trajectories; `style` holds colours, markers and the style sheet of
all figures.

Imports `support`, and of `mechanics` the type of a trajectory alone; Matplotlib and Pillow are imported when something
is drawn. A new view is a class of `views`, which `render` places; a new figure takes its colours and its style from
`style`.
"""
