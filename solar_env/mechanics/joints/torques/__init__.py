"""Torques about a hinge, in one module for each kind, and their sum (`hinge.py`).

A torque is a function of a joint's constants, state, angle and rate; angle and rate are numbers or vectors. To add a
torque, write a module here, add an entry to `arrays.columns.TORQUES`, and call the module in `hinge.py`. All
formulations of the equations of motion take torques, slopes, energies and powers from `hinge.py`.
"""
