"""The step in hand, as the run loop and all methods see it: its trial, and the motion of the joints at its ends."""

import numpy as np

from solar_env.mechanics.arrays.model import record

trial_type = record(
    [
        ("wanted", np.float64),  # step [s] that the method would take if the call did not end
        ("step", np.float64),  # step [s] that is tried: at most up to the end of the call
        ("error", np.float64),  # in units of the tolerance
        ("retry", np.float64),  # step [s] to try after a refused one if the error does not tell; negative: give up
        ("reason", np.int64),  # status code of a method that has no step left to try; 0 leaves it to the run loop
        ("joint", np.int64),  # joint that has kept the method from solving its equations, or -1
        ("last", np.int64),  # whether the step ends the call
        ("cuts", np.int64),  # how often it has been solved again, to end on an event
        ("at_once", np.int64),  # number of events that have followed each other without time between them
        # Of methods in stages: whether the stability of the flexible bodies bounds the step.
        ("bound", np.int64),
        # Whether it is linearly implicit: the accelerations at its end solve the equations of motion only to its
        # tolerance, and the workspace holds no evaluation of accelerations there.
        ("implicit", np.int64),
        # Whether it corrects for stiff contacts: accelerations in between differ from those at its ends.
        ("stiff_contacts", np.int64),
        ("level", np.int64),  # level of modal panels' tables
    ]
)

joint_motion_type = record(
    [
        ("start_depth", np.float64),  # penetration at the start of the step [m]
        ("start_depth_rate", np.float64),  # [m/s]
        ("start_angle", np.float64),  # [rad]
        # At the accepted state.
        ("depth", np.float64),
        ("depth_rate", np.float64),
        ("angle", np.float64),
        ("rate", np.float64),  # [rad/s]
        ("force", np.float64),  # normal force of a contact, or magnitude of an ideal joint's reaction [N]
        ("sliding_work", np.float64),  # sliding work of the step up to the accepted state [J]
    ]
)
