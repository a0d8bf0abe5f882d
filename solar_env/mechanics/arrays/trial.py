"""Record types shared by run loop and integration methods: trial step, and joint motion at both ends of a step."""

import numpy as np

from solar_env.mechanics.arrays.model import record

trial_type = record(
    [
        ("wanted", np.float64),  # step [s] that the method would take if the call did not end
        ("step", np.float64),  # step [s] that is tried; it reaches at most to the end of the call
        ("error", np.float64),  # error of the step in units of the tolerance
        ("retry", np.float64),  # step [s] to try after a rejection; 0: derive it from the error; negative: give up
        ("reason", np.int64),  # status code if the method gives up; 0: the run loop chooses the code
        ("joint", np.int64),  # joint that has kept the method from solving its equations, or -1
        ("last", np.int64),  # whether the step ends the call
        ("cuts", np.int64),  # number of times that the step was shortened to end on an event
        ("at_once", np.int64),  # number of events that have followed each other with no time between
        # In methods with stages: whether the stability limit of the flexible bodies bounds the step.
        ("bound", np.int64),
        # Whether the step is linearly implicit. Its end accelerations then solve the equations of motion only to the
        # tolerance, and the workspace holds no evaluation of accelerations at the end.
        ("implicit", np.int64),
        # Whether the step corrects for stiff contacts: accelerations inside the step then differ from its end values.
        ("stiff_contacts", np.int64),
        ("level", np.int64),  # index of the step size in the modal panels' response tables; -1 if not tabulated
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
