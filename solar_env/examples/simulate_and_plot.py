"""Simulate an array whose two hinges differ in clearance, and plot the peak contact force against the impact speed.

In a Hertzian impact the kinetic energy m v^2 / 2 becomes the elastic energy 2/5 K depth^(5/2). The peak force
K depth^(3/2) therefore grows as v^(6/5), which is the straight line in the picture.
"""

import sys

import numpy as np
from matplotlib.figure import Figure

import solar_env

trajectory = solar_env.simulate({"clearance": (1e-4, 2e-4)}, model="rigid-clearance", duration=30.0)
impacts = trajectory.contacts[trajectory.contacts["start_s"] > trajectory.latch_times.min()]

figure = Figure(figsize=(6.0, 4.0), layout="constrained")
axes = figure.subplots()
for joint in (0, 1):
    of_joint = impacts[impacts["joint"] == joint]
    axes.loglog(1e3 * of_joint["impact_speed"], of_joint["peak_force"], ".", label=f"joint {joint + 1}")
speed = np.array([0.5, 100.0])
axes.loglog(speed, 10.0 * speed**1.2, "k--", label="slope 6/5")
axes.set(xlabel="impact speed [mm/s]", ylabel="peak force [N]", title="The peak force grows as the impact speed to 6/5")
axes.legend()
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "simulate_and_plot.png", dpi=100)
