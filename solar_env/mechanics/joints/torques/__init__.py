"""Torques about a hinge, a module each, and their sum (`hinge.py`).

A torque is a function of the joint's row, its state, its angle and its rate, which are numbers or vectors of several.
To add one: a module here, a row in `arrays.columns.TORQUES`, and its lines in `hinge.py`, which all equations of motion
ask for torques, slopes, energies and powers.
"""
