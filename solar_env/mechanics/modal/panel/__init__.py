"""The modes of a panel: what they answer to a step, by tables, and what bending does to the panel's axis.

Imports `bodies` and `numerics`. `oscillators` treats one mode, `tables` holds all of a design's answers, `ends` and
`coupling` sum them up in a step; `foreshortening` has the forms that `coupling` uses.
"""
