"""Slender panels as modes in floating frames, and an integration method whose only unknowns are the joint loads.

A panel is a rigid body with elastic modes. `tables` holds the modes' responses to loads during a time step, and `ends`
sums them up at the panel's ends. Mechanisms of rigid bodies and modal panels have arrays of their own (`arrays`,
`build`). A step of the three-stage Radau IIA method solves for the joint loads at its stages (`solve`). Given these
loads, every body's motion follows in closed form (`motion`), so that the cost of an iteration does not depend on the
number of modes. `unknowns` and `equations` make Newton's matrix, `elimination` factors it, and `acceptance` estimates
the step's error. `method` has the kernels that the run loop calls.

Modal panels are a formulation of their own, not a kind of body in `bodies.kinds`. The coordinates of bodies there are
unknowns of a step and have a mass matrix. Modal amplitudes follow from the loads, like the motion of all bodies here.

The formulation leaves out two effects. First, the inertia of the turning frame (centrifugal and Coriolis forces on the
amplitudes) would raise the squared frequency of a free panel's lowest mode by 2.05 spin^2. At a spin of 10 % of that
frequency (6.8 rad/s for a panel of the array), the frequency is 1.0 % too low. Second, bending terms beyond second
order are left out. If an end has the slope theta relative to the frame, a static tip deflection is too small by the
fraction 0.05 theta^2. A run warns if the first effect reaches 1 % of the lowest mode's stiffness, or the second 1 % of
the shortening by bending (`verification.panels` measures both).

Foreshortening, the shortening of a panel's axis by bending, is computed from the shapes of the four lowest bending
modes, and from static shapes under end loads for all other modes together. Three axial modes respond to it as
oscillators. What it would excite in higher axial modes moves the panel's ends without delay. With ideal joints, the
array's peak reactions agree within 0.1 % with 48-element beams.

The method is of order five in motion and three in the loads at the ends of its steps. With ideal joints,
foreshortening lowers the measured order of motion to 3.4. The package imports `records` and the packages below it.
"""
