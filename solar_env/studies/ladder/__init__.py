"""The ladder: levels of the model, with the questions that each answers, and its cost.

`campaign` simulates every level, compares it with a finer reference and measures all into the table of
`solar_env.array.ladder`, `plot` draws the table. Imports `common`. A further question is a row of `QUESTIONS` there and
an answer in `campaign`.
"""
