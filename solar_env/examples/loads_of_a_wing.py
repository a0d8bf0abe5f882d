"""Find the loads on the hinges of APPLE, an array with two wings from published data, and their uncertainty.

Impacts are chaotic, so that one run says little: an ensemble is sampled from the tolerances in the array's file. It
runs at a chosen and at the finest model level. The mean difference between them is the discretisation error.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from matplotlib.figure import Figure
from rich.console import Console

from solar_env.array.parameters.file import named_array
from solar_env.studies.loads.ensemble import LoadsPlan, measure_loads
from solar_env.studies.loads.report import answer

RUNS = int(sys.argv[2]) if len(sys.argv) > 2 else 8

if __name__ == "__main__":
    plan = LoadsPlan(named_array("apple"), "rigid-clearance", members=RUNS, window=2.0)
    with TemporaryDirectory() as folder:
        loads = measure_loads(plan, Path(folder), 2, Console(stderr=True))
    print(*answer(loads), sep="\n")
    names = [joint.name for joint in plan.array.parameters.joints]
    figure = Figure(figsize=(6.0, 4.0), layout="constrained")
    axes = figure.subplots()
    torques = loads.figures["latch_torque"]
    axes.bar(names, [each.mean for each in torques], yerr=[each.half_width for each in torques], capsize=4)
    axes.tick_params(axis="x", labelsize=7)
    axes.set(ylabel="peak torque of the latch [N m]", title="The root hinges of both wings are loaded most")
    figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "loads_of_a_wing.png", dpi=100)
