"""Gymnasium environments of the deployment: one array, and many arrays in one compiled call.

`env` and `vector_env` are the shells that Gymnasium knows; `episodes` and `setup` run episodes, `task` observes,
charges and ends them, `scenarios` say what an episode draws, `hardware` and `sensors` what the drive measures and
applies, `film` what is rendered.

Imports `array`, `mechanics`, `pictures` and `support`. A scenario is a row of `scenarios`, and so are an observation
and a reward term in their tables: single and vector environments follow.
"""
