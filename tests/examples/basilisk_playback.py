"""The loads of a deploying array on a spacecraft in Basilisk: `pip install bsk`, then

solar-env loads my_array.toml --hub hub.csv
python tests/examples/basilisk_playback.py hub.csv

`extForceTorque` holds each row's mean force and torque for its time, on a hub of the mass and inertia that the table
has from the array's parameters. Basilisk's spacecraft then has the momentum of the deployment's hub at every row; its
attitude differs by what the torque varies within a row.
"""

import sys

import numpy as np
from Basilisk.simulation import extForceTorque, spacecraft
from Basilisk.utilities import SimulationBaseClass, macros


def attitude_history(table: np.ndarray) -> np.ndarray:
    """(rows, 2) angle [rad] and rate [rad/s] of the hub about z at the end of each row of a table of `loads --hub`."""
    mass, inertia = float(table["hub_mass_kg"][0]), float(table["hub_inertia_kgm2"][0])
    step = float(table["end_s"][0] - table["start_s"][0])
    simulation = SimulationBaseClass.SimBaseClass()
    process = simulation.CreateNewProcess("dynamics")
    process.addTask(simulation.CreateNewTask("dynamics", macros.sec2nano(step)))
    hub, loads = spacecraft.Spacecraft(), extForceTorque.ExtForceTorque()
    hub.hub.mHub, hub.hub.IHubPntBc_B = mass, [[inertia, 0.0, 0.0], [0.0, inertia, 0.0], [0.0, 0.0, inertia]]
    hub.addDynamicEffector(loads)
    simulation.AddModelToTask("dynamics", hub)
    simulation.AddModelToTask("dynamics", loads)
    simulation.InitializeSimulation()
    simulation.ConfigureStopTime(0)
    simulation.ExecuteSimulation()
    history = np.zeros((len(table), 2))
    columns = ("start_s", "end_s", "force_x_N", "force_y_N", "torque_z_Nm")
    for row, (start, end, force_x, force_y, torque) in enumerate(table[list(columns)].tolist()):
        if end - start < 0.999 * step:
            return history[:row]  # a last, shorter row
        loads.extForce_N = [force_x, force_y, 0.0]
        loads.extTorquePntB_B = [0.0, 0.0, torque]
        simulation.ConfigureStopTime((row + 1) * macros.sec2nano(step))
        simulation.ExecuteSimulation()
        state = hub.scStateOutMsg.read()
        history[row] = 4.0 * np.arctan(state.sigma_BN[2]), state.omega_BN_B[2]
    return history


if __name__ == "__main__":
    rows = np.genfromtxt(sys.argv[1], delimiter=",", names=True)
    angle, rate = attitude_history(rows)[-1]
    print(f"after {rows['end_s'][-1]:.3f} s the hub has turned by {np.degrees(angle):.4f} deg, at {rate:.3e} rad/s")
