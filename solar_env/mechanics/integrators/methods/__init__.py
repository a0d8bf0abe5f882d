"""Integration methods; `table` has their kernels, a row a method.

Imports `settings` and `formulations` of the room around it, `modal`, `records` and the equations with what lies below
them. `rosenbrock` and `stage_steps` offer methods in stages to the run loop; their steps are in `runge_kutta`,
with `stiff_forces`, and in `rosenbrock_step`; `stages` has their arrays and interpolants.

To add a method, write its module: a named tuple of its settings, a function that makes its arrays, and the kernels that
`table.Kernels` lists. Its settings are a class of `settings`, and its row in `table.METHODS` states its order.
Command line, warm-up, batches and the tests of every method follow.
"""
