"""Running mechanisms: simulations, batches of them on all cores, trajectories, accuracy, diagnosis and errors.

Imports `integrators` and the rooms below. A new figure of a run is a property of `Trajectory`, a new warning a
function of `diagnosis`.
"""
