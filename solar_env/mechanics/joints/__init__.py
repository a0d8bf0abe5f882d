"""Forces in a joint: kinematics of its markers, contact and friction laws, wear, springs, stops and cable loops.

Imports `bodies`, `arrays` and `numerics`. `laws.py` says how to add a contact law, `torques` how to add a
torque about a hinge.
"""
