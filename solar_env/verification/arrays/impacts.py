"""Verification of impacts within a deployment: each impact at default settings against a second, accurate solution.

Deployments with clearance are chaotic: two runs soon have different impacts. Each impact is therefore solved a second
time by the same method, from the state in which it began, with a far smaller tolerance. This shows the error of the
time steps alone; `restitution`, `modal-struck-bar` and `modal-struck-beam` compare impacts with closed forms.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, build, default_integrator
from solar_env.mechanics.arrays.model import State
from solar_env.mechanics.integrators.settings import Integrator, RungeKutta
from solar_env.mechanics.joints.joint import penetration
from solar_env.mechanics.modal.arrays import DEPTH, DEPTH_RATE, ModalModel, ModalState
from solar_env.mechanics.records.history import IMPACT_DURATIONS
from solar_env.mechanics.records.recording import make_recorder
from solar_env.mechanics.running.simulation import Simulation
from solar_env.verification.checks import Check

_CHUNK = 0.01  # chunk of a run [s], too short for chaos to separate the run from its repetition
_CORRECTIONS = 4  # Newton corrections of the time at which surfaces separate
_MOST_CONTACTS = 4096  # most contacts in a chunk or in one impact
_STEPS_PER_IMPACT = 40.0  # steps per impact in the tight runs
# Longest impact in predicted durations, 8 ms; longer contacts are no impacts. Modal panels give way, so that an impact
# lasts some 35 times as long as predicted: the prediction holds only at the start of a panel's deformation.
_LONGEST_MODAL = 100.0
_FAST = 0.01  # impact speed [m/s] from which on impacts cause the peak forces
_ALONE = "impacts that other joints' impacts do not draw out"
_EXPLICIT = "the same impact from the same state, rtol 1e-10, 40 steps an impact"
_TIGHTER = "the same impact from the same state and by the same method, a hundredth of rtol, 40 steps an impact"

Column = NDArray[np.float64]


def _contacts(simulation: Simulation, end_time: float) -> list[tuple[float, int, float]]:
    """Advance to `end_time` [s]; return (start [s], joint, end [s]) of every contact; end is nan if it still lasts."""
    recorder = make_recorder(simulation.model, simulation.state, np.zeros(0), _MOST_CONTACTS)
    simulation.advance(end_time, recorder)
    rows = recorder.contacts[: recorder.filled[1]]
    ended = [(float(start), int(joint), float(end)) for joint, start, end in rows[:, :3]]
    joints = simulation.state.joints
    return ended + [(float(joints["contact_start"][j]), int(j), np.nan) for j in np.flatnonzero(joints["in_contact"])]


def _depth(simulation: Simulation, j: int) -> tuple[float, float]:
    """Return the penetration depth [m] of joint `j`, negative for a gap, and its rate [m/s]."""
    model, state = simulation.model, simulation.state
    if isinstance(model, ModalModel):
        return float(state.motion[j, DEPTH]), float(state.motion[j, DEPTH_RATE])
    depth, rate = penetration(model.joints[j], model.markers, state.q, state.v)
    return float(depth), float(rate)


def _exit(simulation: Simulation, start: State | ModalState, j: int, longest: float) -> tuple[float, ...]:
    """Return exit speed [m/s] and duration [s] of the contact begun at joint `j` in state `start`, and contact count.

    The count is of contacts at all joints. Return () if the contact lasts more than `longest` times the duration that
    was predicted when it began.
    """
    begun, duration = float(start.joints[j]["contact_start"]), float(start.joints[j]["contact_duration"])
    simulation.restore(start)
    # The first run leaves all steps to the method; Newton's method then corrects the linear estimate of the end.
    contacts = _contacts(simulation, begun + longest * duration)
    end = next(end for other_start, joint, end in contacts if (other_start, joint) == (begun, j))
    rate = -1.0
    for _ in range(_CORRECTIONS):
        if not begun < end < begun + longest * duration:
            return ()
        simulation.restore(start)
        simulation.advance(end)
        depth, rate = _depth(simulation, j)
        end -= depth / rate
    return -rate, simulation.time - begun, float(simulation.state.joints["contact_starts"].sum())


def impacts(
    model: str, duration: float, tight: Integrator, longest: float, slowest: float = 0.0
) -> tuple[Column, Column, float]:
    """Simulate a deployment by the default integration method, and each of its impacts a second time by `tight`.

    Args:
        model: model level, such as rigid-clearance.
        duration: duration of the deployment [s].
        tight: accurate integration method of each impact's second run, in the same formulation as the default method.
        longest: greatest ratio of an impact's duration to its predicted duration; longer contacts are left out.
        slowest: exit speed [m/s] in the second run below which the default method may miss a separation.

    Returns:
        Impact speeds [m/s] and exit-speed errors [m/s] of the impacts that agree in both runs: equally many contacts,
        durations within 10 %. Last comes the fraction of impacts that disagree. Impacts that disagree and leave more
        slowly than `slowest` are not counted: time steps may pass over gaps of some nanometres at any joint.
    """
    mechanism = build(ArrayParameters(), model)
    run, tight_run = Simulation(mechanism, default_integrator(model)), Simulation(mechanism, tight)
    rows: list[tuple[float, ...]] = []
    while run.time < duration:
        before = run.snapshot()
        starts = sorted(contact[:2] for contact in _contacts(run, before.clock["time"][0] + _CHUNK))
        after = run.snapshot()
        for begun, j in starts:
            if begun <= before.clock["time"][0]:
                continue
            run.restore(before)
            run.advance(begun + 1e-9)
            start = run.snapshot()
            joint = start.joints[j]
            # A journal at the minimum impact speed leans on its bearing, as does a journal in contact for long.
            leans = joint["impact_speed"] <= run.model.joints[j]["minimum_impact_speed"]
            if joint["in_contact"] and joint["contact_start"] > before.clock["time"][0] and not leans:
                ends = [_exit(simulation, start, j, longest) for simulation in (run, tight_run)]
                if all(ends):
                    rows.append((float(joint["impact_speed"]), *ends[0], *ends[1]))
        run.restore(after)
    speed, exit_speed, length, contacts, tight_exit_speed, tight_length, tight_contacts = np.array(rows).T
    same = (contacts == tight_contacts) & (np.abs(length - tight_length) < 0.1 * tight_length)
    told = same | (tight_exit_speed >= slowest)
    return speed[same], np.abs(exit_speed - tight_exit_speed)[same], 1.0 - float(same[told].mean())


def _compared(name: str, number: int, at_least: int, left_out: float) -> Iterator[Check]:
    """Yield checks that enough impacts, `number`, were compared, and that a fraction `left_out` <= 0.01 was not."""
    missing = max(at_least - number, 0)
    yield Check(f"{name}: impacts compared: {number}, at least {at_least}", 0.0, missing, 0.0, _ALONE)
    quantity = f"{name}: share of the impacts left out, where surfaces part for a moment in one of the two runs alone"
    yield Check(quantity, 0.0, left_out, 0.01, "gaps of some nanometres")


def explicit_impacts() -> Iterator[Check]:
    """Yield checks of the explicit method's impact exit speeds (rigid panels) against accurate runs of each impact."""
    name, tight = "rigid-clearance, 30 s", RungeKutta(rtol=1e-10, impact_resolution=_STEPS_PER_IMPACT)
    speed, errors, left_out = impacts("rigid-clearance", 30.0, tight, IMPACT_DURATIONS)
    yield from _compared(name, speed.size, 1000, left_out)
    yield Check(f"{name}: largest error of a restitution", 0.0, (errors / speed).max(), 4e-3, _EXPLICIT)


def modal_impacts() -> Iterator[Check]:
    """Yield checks of impact exit speeds, with modally reduced flexible panels, against accurate runs of each impact.

    The integrator's tolerance corresponds to a speed of 0.1 mm/s. Exit speeds of slow impacts are therefore judged by
    their absolute errors, not by errors relative to the impact speed.
    """
    model = "flexible-clearance"
    name, default = f"{model}, 32 modes a panel, 16 s", default_integrator(model)
    tight = replace(default, rtol=0.01 * default.rtol, impact_resolution=_STEPS_PER_IMPACT)
    tolerance_of_speeds = default.rtol * default.velocity_scale
    speed, errors, left_out = impacts(model, 16.0, tight, _LONGEST_MODAL, tolerance_of_speeds)
    yield from _compared(name, speed.size, 150, left_out)
    shares = errors / speed
    for quantity, obtained, tolerance in (
        ("median error of a restitution", np.median(shares), 2e-3),
        ("share of restitutions off by more than 1 %", np.mean(shares > 0.01), 0.2),
        (f"largest error of one, from {_FAST:g} m/s on", shares[speed >= _FAST].max(), 3e-3),
        ("largest error of an exit speed [m/s]", errors.max(), 3.0 * tolerance_of_speeds),
    ):
        yield Check(f"{name}: {quantity}", 0.0, float(obtained), tolerance, _TIGHTER)
