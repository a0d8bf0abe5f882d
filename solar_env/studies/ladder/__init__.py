"""Which level of the model answers which question, and at what cost.

`runs` simulates every level, `answers` compares them with a finer reference, `campaign` measures all into the table of
`solar_env.array.ladder`, `plot` draws it. Imports `common`. A further question is a row of `QUESTIONS` there and its
answer here.
"""
