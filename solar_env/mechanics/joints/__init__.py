"""Forces in a joint: marker kinematics, contact and friction laws, wear, springs, stops and cable loops.

This package imports `bodies`, `arrays` and `numerics`. `laws.py` explains how to add a contact law, `torques` how to
add a torque about a hinge.
"""
