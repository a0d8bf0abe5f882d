"""Forces in a joint: kinematics of its markers, contact and friction laws, wear, springs, stops and cable loops.

Imports `bodies`, `arrays` and `numerics`. The rooms `contact` and `friction` say how to add a law, `torques.py` how to
add a torque about a hinge.
"""
