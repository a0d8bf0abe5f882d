"""Integration methods; `table` lists the kernels of every method.

The package imports `settings` and `formulations` from `integrators`; `modal`, `records` and `equations`; and packages
that those import. `rosenbrock` and `stage_steps` connect the methods with stages to the run loop. The steps are in
`runge_kutta`, with `stiff_forces`, and in `rosenbrock_step`; `stages` has arrays and interpolants for both.

To add a method, write a module with a named tuple of its settings, a function that makes its arrays, and the kernels
that `table.Kernels` lists. Add a settings class to `integrators/settings.py`, and an entry with the method's order to
`table.METHODS`. Command line, warm-up, batches and the tests of every method then include the new one.
"""
