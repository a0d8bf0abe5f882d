"""Which values of what the paper leaves open meet its numbers and statements at once: `paper --identify`.

`open_parameters` has these quantities with their ranges, `search` measures the claims of `paper.claims` over them,
`stages` says in which order, `exclusions` which claims no searched set meets together; `plot` draws that. A further
quantity is a row of `OPEN_PARAMETERS`. Imports the rest of the study.
"""
