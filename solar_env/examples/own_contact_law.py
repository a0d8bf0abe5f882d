"""Add a contact law of your own, and compare the exit speeds that contact laws give for a coefficient of restitution.

A contact law F = K depth^n (1 + d rate / v) dissipates by its damping factor d alone; v is the entry speed. Whatever
mass, v and K, the ratio e of exit speed to v solves d (1 + e) = ln[(1 + d) / (1 - d e)]. For a restitution c, S. Hu and
X. Guo take d = 3 (1 - c) / (2 c), Multibody Syst. Dyn. 35 (2015) 131, doi:10.1007/s11044-015-9453-z.
"""

import sys

import numpy as np
from matplotlib.figure import Figure

import solar_env
from solar_env.mechanics.joints.laws import CONTACT_LAWS, contact_law, sphere

CONTACT_LAWS["hu-guo"] = lambda surfaces, e: sphere(surfaces, 1.5 * (1.0 - e) / e)

surfaces = solar_env.ArrayParameters().surfaces(0)
asked = np.linspace(0.1, 1.0, 19)
figure = Figure(figsize=(6.0, 4.0), layout="constrained")
axes = figure.subplots()
for name in ("lankarani-nikravesh", "flores", "restitution", "hu-guo"):
    axes.plot(asked, [contact_law(name, surfaces, e).exit_speed_ratio() for e in asked], label=name)
own = solar_env.simulate({"contact_law": "hu-guo", "restitution": 0.5}, duration=14.0)
axes.set(
    xlabel="coefficient of restitution",
    ylabel="exit speed / entry speed",
    title=f"With the new law, asked for 0.5, joint 1 is hit with {own.peak_force[0]:.0f} N",
)
axes.legend()
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "own_contact_law.png", dpi=100)
