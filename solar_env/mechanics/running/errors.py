"""Exceptions of a run; each message names the quantity, its value, the time, and a remedy."""

from typing import Any

from solar_env.mechanics.arrays import model as m


class SimulationError(RuntimeError):
    """Error of a run that cannot continue; the state is left at the last accepted step.

    Attributes:
        time: last accepted time [s].
        reason: short name of the cause, such as `"newton"`.
    """

    def __init__(self, message: str, time: float, reason: str) -> None:
        super().__init__(message)
        self.time = time
        self.reason = reason

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the error with all arguments, so that it can pass from a worker to another process."""
        return type(self), (str(self), self.time, self.reason)


_CAUSES = {
    m.STEP_TOO_SMALL: (
        "step_size",
        "the step shrank below rounding with an error (local, or of Newton's iteration) of {value:.3g} tolerances; "
        "loosen rtol, or soften the stiffest element",
    ),
    m.NOT_FINITE: (
        "not_finite",
        "the state is no longer finite; reduce the step or the tolerance, or check stiffnesses and torques",
    ),
    m.SINGULAR_CONSTRAINTS: (
        "constraints",
        "the constraints are redundant or contradict each other in this configuration; remove one, or "
        "pass a dead point with GeneralizedAlpha",
    ),
    m.NEWTON_FAILED: (
        "newton",
        "Newton's iteration did not converge (last residual {value:.3g} tolerances); reduce the step",
    ),
    m.NEWTON_STALLED: (
        "joint_loads",
        "Newton's iteration on the loads of joint {joint} converges at no step size; let its friction set in over "
        "higher speeds, remove what holds its bodies twice, or use beam elements (FlexibleBody, '...:6 elements')",
    ),
    m.JOINT_ANGLE_RANGE: (
        "joint_angle",
        "the angle of joint {joint} reached {value:.4g} rad, outside the range in which its torques are defined; "
        "reduce the motor torque, or stiffen the stops",
    ),
    m.CONTACT_TOO_DEEP: (
        "penetration",
        "the journal of joint {joint} sank {value:.3g} m into its bearing, more than its radius; reduce the step, or "
        "check the contact stiffness",
    ),
    m.EVENTS_PILE_UP: (
        "events",
        "joint {joint} strikes, latches or meets its stop for ever without time going on ({value:.0f} times); tighten "
        "rtol, or check its angles and clearance",
    ),
    m.TOO_MANY_STEPS: (
        "steps",
        "{value:.0f} steps were taken in one call without reaching its end; loosen rtol, or raise max_steps of the "
        "integrator or the environment",
    ),
}


def failure(status: int, clock: Any) -> SimulationError:
    """Return the error for a status code (not DONE, PAUSED); `clock` holds time, joint and value for the message."""
    (reason, text), time = _CAUSES[status], float(clock["time"])
    cause = text.format(joint=int(clock["failure_joint"]) + 1, value=float(clock["failure_value"]))
    return SimulationError(f"at t = {time:.9g} s {cause}", time, reason)
