"""Peak force and wear over the design's parameters, and repeated ground tests with the worn clearance fed back.

Imports `common`. A further map is a row of `MAPS` in `design_map`, a further quantity a row of `MAPPED` in `plots`.
"""
