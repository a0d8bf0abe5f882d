"""Current step of a method with stages: derivatives, end, and the Hermite interpolant between start and end.

In every method, row 0 of the stage arrays holds the derivatives at the step's start, and the last row the derivatives
at its end. In between, positions follow the quintic and velocities the cubic Hermite polynomial through all end values
(E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I, 1993, section II.6,
doi:10.1007/978-3-540-78862-1).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import ENERGIES, EXACT, State
from solar_env.mechanics.equations.system import accelerations
from solar_env.mechanics.joints.joint import relative
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into


class Stages(NamedTuple):
    """Stage derivatives and end values of the current step, and work arrays."""

    velocity: NDArray[np.float64]  # (stages, n)
    acceleration: NDArray[np.float64]  # (stages, n)
    power: NDArray[np.float64]  # (stages, integrals)
    q: NDArray[np.float64]  # (n,) stage or end coordinates
    v: NDArray[np.float64]  # (n,)
    gain: NDArray[np.float64]  # integrals over the whole step
    scratch_q: NDArray[np.float64]  # (n,) interpolated coordinates
    scratch_v: NDArray[np.float64]  # (n,)
    scratch_a: NDArray[np.float64]  # (n,)
    integrals: NDArray[np.float64]  # interpolated integrals
    energies: NDArray[np.float64]  # (ENERGIES,)
    ratios: NDArray[np.float64]  # (n,) error divided by tolerance
    multipliers: NDArray[np.float64]  # (m + bodies,) work array; multipliers at the end of a linearly implicit step


def make_stages(state: State, rows: int) -> Stages:
    """Allocate the arrays of a step with `rows` stages, including the stage at the step's end."""
    n, k = state.q.size, state.integrals.size
    return Stages(
        velocity=np.zeros((rows, n)),
        acceleration=np.zeros((rows, n)),
        power=np.zeros((rows, k)),
        q=np.zeros(n),
        v=np.zeros(n),
        gain=np.zeros(k),
        scratch_q=np.zeros(n),
        scratch_v=np.zeros(n),
        scratch_a=np.zeros(n),
        integrals=np.zeros(k),
        energies=np.zeros(ENERGIES),
        ratios=np.zeros(n),
        multipliers=np.zeros(state.multipliers.size),
    )


@kernel
def set_impact_speeds(joint_states, impact_speeds):
    """Write the joints' impact speeds [m/s] to `impact_speeds` (joints,); they are zero for joints without contact."""
    for j in range(joint_states.size):
        impact_speeds[j] = joint_states[j].impact_speed if joint_states[j].in_contact else 0.0


@kernel(inlined=False)
def refresh(model, state, stages, work):
    """Compute the accelerations at `state`, and the rates of all works, losses and impulses.

    Write them to `state.a` and `state.power`, and to the first rows of `stages.acceleration` and `stages.power`.
    `work` is overwritten. Return False if the constraints are singular.
    """
    set_impact_speeds(state.joints, work.impact_speeds)
    clock = state.clock[0]
    regular = accelerations(
        model,
        state.joints,
        state.q,
        state.v,
        clock.time,
        work,
        stages.acceleration[0],
        state.multipliers,
    )
    clock.evaluations += 1
    clock.acceleration_current = EXACT if regular else 0
    copy_into(stages.power[0], work.power)
    copy_into(state.a, stages.acceleration[0])
    copy_into(state.power, work.power)
    return regular


@kernel
def quintic_weights(s):
    """Return quintic Hermite weights at step fraction `s`: of x, x' h and x'' h^2 at the start, then at the end."""
    s3 = s * s * s
    end = s3 * (10.0 - s * (15.0 - 6.0 * s))
    return (
        1.0 - end,
        s - s3 * (6.0 - s * (8.0 - 3.0 * s)),
        0.5 * s * s * (1.0 - s * (3.0 - s * (3.0 - s))),
        end,
        -s3 * (4.0 - s * (7.0 - 3.0 * s)),
        0.5 * s3 * (1.0 - s * (2.0 - s)),
    )


@kernel
def cubic_weights(s):
    """Return cubic Hermite weights at fraction `s` of a step: of value and slope * h at its start, then at its end."""
    end = s * s * (3.0 - 2.0 * s)
    return 1.0 - end, s * (1.0 - s) * (1.0 - s), end, s * s * (s - 1.0)


@kernel(inlined=False)
def hermite_state(state, stages, h, share):
    """Write the interpolated state at the fraction `share` of the step to `stages.scratch_q` and `.scratch_v`."""
    q0, v0, q1, v1 = state.q, state.v, stages.q, stages.v
    acceleration, q, v = stages.acceleration, stages.scratch_q, stages.scratch_v
    p0, p1, p2, r0, r1, r2 = quintic_weights(share)
    c0, c1, d0, d1 = cubic_weights(share)
    for i in range(q.size):
        a0, a1 = h * acceleration[0, i], h * acceleration[-1, i]
        q[i] = p0 * q0[i] + r0 * q1[i] + h * (p1 * v0[i] + r1 * v1[i] + p2 * a0 + r2 * a1)
        v[i] = c0 * v0[i] + c1 * a0 + d0 * v1[i] + d1 * a1


@kernel
def hermite_depth(joint, markers, state, stages, h, share):
    """Return a joint's penetration [m] at `share` of the step, by interpolating only the joint's eccentricity."""
    acceleration = stages.acceleration
    p0, p1, p2, r0, r1, r2 = quintic_weights(share)
    ex0, ey0 = relative(joint, markers, state.q)
    ex1, ey1 = relative(joint, markers, stages.q)
    ux0, uy0 = relative(joint, markers, state.v)
    ux1, uy1 = relative(joint, markers, stages.v)
    ax0, ay0 = relative(joint, markers, acceleration[0])
    ax1, ay1 = relative(joint, markers, acceleration[-1])
    ex = p0 * ex0 + r0 * ex1 + h * (p1 * ux0 + r1 * ux1 + h * (p2 * ax0 + r2 * ax1))
    ey = p0 * ey0 + r0 * ey1 + h * (p1 * uy0 + r1 * uy1 + h * (p2 * ay0 + r2 * ay1))
    return math.sqrt(ex * ex + ey * ey) - joint.clearance


@kernel
def interpolate_without_accelerations(state, stages, h, share):
    """Compute `stages.scratch_q` at `share` of the step from coordinates and velocities at its ends alone.

    Use it for steps corrected for stiff contacts. Their end accelerations, which differ from the accelerations in
    between, would open or overload a lasting contact of only some nanometres depth.
    """
    q0, v0, q1, v1, q = state.q, state.v, stages.q, stages.v, stages.scratch_q
    c0, c1, d0, d1 = cubic_weights(share)
    for i in range(q.size):
        q[i] = c0 * q0[i] + d0 * q1[i] + h * (c1 * v0[i] + d1 * v1[i])


@kernel
def hermite_integrals(state, stages, h, share):
    """Write works, losses and impulses, interpolated at fraction `share` of a step `h` [s], to `stages.integrals`."""
    integrals, gain, power, base = stages.integrals, stages.gain, stages.power, state.integrals
    _, start, whole, end = cubic_weights(share)
    for k in range(integrals.size):
        integrals[k] = base[k] + whole * gain[k] + h * (start * power[0, k] + end * power[-1, k])
