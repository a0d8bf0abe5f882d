"""Integration methods; `table` lists the kernels of every method.

From its parent `integrators`, this package imports only `settings` and `formulations`. It also imports the packages
`modal`, `records` and `equations`, and packages that they import. `rosenbrock` and `stage_steps` connect Runge-Kutta
and Rosenbrock with the run loop. Their steps are in `runge_kutta` and `rosenbrock_step`, their arrays and interpolants
in `stages`. `stiff_forces` adds an implicit treatment of stiff stops and contacts to Runge-Kutta steps.

To add a method, write a module with a named tuple of its settings, a function that makes its arrays, and the kernels
that `table.Kernels` lists. Add a settings class to `integrators/settings.py`, and an entry with the method's order to
`table.METHODS`. Command line, warm-up, batches and the tests of every method then include the new one.
"""
