"""Slender panels as modes in a floating frame, and a method that steps on the loads of the joints alone.

A panel is a rigid body with elastic modes about it (`foreshortening`, `tables`); a mechanism of rigid bodies and
such panels has arrays of its own (`arrays`, `build`). A step of the two-stage Radau IIA method solves for the loads
of the joints at its two stages (`bodies`, `motion`, `rows`, `equations`, `step`) and is then judged and taken
(`acceptance`): given the loads, every body's motion follows in closed form, so that the cost of the iteration does not
depend on the number of modes. `driver` controls the steps, `events` and `books` keep what a run remembers;
`formulation` and `views` tell the rest of the package what the arrays say.

Imports `records` and the rooms below.
"""
