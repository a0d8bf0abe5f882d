"""Slender panels as modes in a floating frame, and a method that steps on the loads of the joints alone.

A panel is a rigid body with elastic modes about it, whose answers to a step are in `tables`; `ends` sums them up. A
mechanism of rigid bodies and such panels has other arrays (`arrays`, `build`). A step of the three-stage Radau IIA
method solves for the loads of the joints at its stages (`solve`): given the loads, every body's motion follows in
closed form (`motion`), so that the cost of the iteration does not depend on the number of modes. `unknowns` and
`equations` make Newton's matrix, which `elimination` factors, `acceptance` judges the step, and `method` has the
kernels that the run loop calls; `formulation` tells the rest of the package what the arrays say.

Modal panels are a formulation and no row of `bodies.kinds`: a row has coordinates that the integrators step together
with all others, places of its markers that follow from them alone, and a mass matrix that acts on nothing but its own.
Here amplitudes are no unknowns of a step at all; they follow from the loads, and so do the bodies beside them.

Two things are left out. The inertia of the turning frame (centrifugal and Coriolis forces on the amplitudes) would
raise the squared frequency of a free panel's lowest mode by 2.05 spin^2: at spins of 3 and 10 % of that frequency
(2.0 and 6.8 rad/s for a panel of the array) the frequency is 0.1 and 1.0 % too low. Of bending, terms beyond the
second order: a static tip deflection is too small by 0.05 of the squared slope of the end against the frame, 0.2 % at
0.2 rad. A run warns where either leaves out 1 % of stiffness or shortening (`verification.panels` measures both).

Besides, foreshortening has the shapes of the four lowest bending modes alone, while all others enter together, with the
shapes in which loads at the ends bend a panel; of the axial modes it excites three, and moves the ends at once with the
rest: the array's peak reactions with ideal joints agree with beams of 48 elements within 0.1 %.

The method is of order five in motion and three in the loads at the ends of its steps. Where joints are ideal,
foreshortening, which reactions follow, lowers the order of motion to 3.4.

Imports `records` and the rooms below.
"""
