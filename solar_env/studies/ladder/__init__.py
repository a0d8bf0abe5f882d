"""The ladder of model levels, from rigid to finely flexible: which questions each level answers, and at what cost.

`campaign` simulates every level, compares it with a finer reference, and writes errors and costs into the table that
`solar_env.array.ladder` reads. `plot` draws the table. Imports `common`. To add a question, add a row to `QUESTIONS` in
`solar_env.array.ladder` and an answer to `campaign`.
"""
