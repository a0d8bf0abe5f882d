"""Cases of the impacts inside a deployment at default settings, each beside the same impact at a tight tolerance.

Deployments with clearance are chaotic: two runs soon have different impacts. Here each impact of the default run is
solved a second time from the very state in which it began.
"""

from collections.abc import Iterator

import numpy as np

from solar_env.array import ArrayParameters, PanelModel, build
from solar_env.array.methods import default_integrator
from solar_env.mechanics.arrays.model import State
from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.joints.joint import penetration
from solar_env.mechanics.records.history import IMPACT_DURATIONS
from solar_env.mechanics.records.recording import make_recorder
from solar_env.mechanics.running.simulation import Simulation
from solar_env.verification.checks import Check

_CHUNK = 0.01  # s, which a run and its repetition up to an impact may share before chaos parts them
_AFTER_START = 1e-9  # s
_LOOKS = 0.1  # of the predicted duration: how often it is looked whether a contact has ended
_SOURCE = "the same impact from the same state, rtol 1e-10, 40 steps an impact"


def _starts(simulation: Simulation, end_time: float) -> list[tuple[float, int]]:
    """Advance, and return time [s] and joint of the contacts that began on the way."""
    begin = simulation.time
    recorder = make_recorder(simulation.model, simulation.state, np.zeros(0), 256)
    simulation.advance(end_time, recorder)
    ended = recorder.contacts[: recorder.filled[1]]
    starts = [(float(row[1]), int(row[0])) for row in ended]
    for j, own in enumerate(simulation.state.joints):
        if own["in_contact"]:
            starts.append((float(own["contact_start"]), j))
    return sorted(start for start in starts if start[0] > begin)


def _advance_until_apart(simulation: Simulation, j: int) -> bool:
    """Advance until joint `j` is out of contact; False if that takes longer than an impact does."""
    own = simulation.state.joints[j]
    start, duration = float(own["contact_start"]), float(own["contact_duration"])
    while simulation.state.joints[j]["in_contact"]:
        if simulation.time > start + IMPACT_DURATIONS * duration:
            return False
        simulation.advance(simulation.time + _LOOKS * duration)
    return True


def _exit_speed(simulation: Simulation, j: int) -> float:
    """Speed [m/s] at which journal and bearing of joint `j` part."""
    joint, markers, state = simulation.model.joints[j], simulation.model.markers, simulation.state
    _, rate = penetration(joint, markers, state.q, state.v)
    return -float(rate)


def _restitutions(run: Simulation, tight: Simulation, start: State, j: int) -> tuple[float, float] | None:
    """Exit over impact speed of one impact in both runs, or None if it is no impact but a lasting contact."""
    speed = float(start.joints[j]["impact_speed"])
    if speed <= run.model.joints[j]["minimum_impact_speed"]:
        return None
    for simulation in (run, tight):
        simulation.restore(start)
        if not _advance_until_apart(simulation, j):
            return None
    both = max(run.time, tight.time)
    for simulation in (run, tight):
        simulation.advance(both)
    return _exit_speed(run, j) / speed, _exit_speed(tight, j) / speed


def restitutions(model: str, duration: float) -> np.ndarray:
    """(impacts, 2) exit over impact speed in a deployment, at default settings and at a tight tolerance.

    The exit speed contains what other joints' impacts and the springs do meanwhile, and can exceed the impact speed.
    Flexible panels are beams of elements, which the explicit method takes.
    """
    panels = PanelModel("ancf", 6)
    mechanism = build(ArrayParameters(), model, panels=panels)
    run = Simulation(mechanism, default_integrator(model, panels))
    tight = Simulation(mechanism, RungeKutta(rtol=1e-10, impact_resolution=40.0))
    found = []
    while run.time < duration:
        before = run.snapshot()
        starts = _starts(run, run.time + _CHUNK)
        after = run.snapshot()
        for start, j in starts:
            run.restore(before)
            run.advance(start + _AFTER_START)
            if run.state.joints[j]["in_contact"]:
                pair = _restitutions(run, tight, run.snapshot(), j)
                found += [pair] if pair else []
        run.restore(after)
    return np.array(found)


def deployment_impacts(model: str, duration: float, at_least: int) -> Iterator[Check]:
    """Impacts of a deployment up to a duration [s], of which at least so many can be compared."""
    pairs = restitutions(model, duration)
    yield Check(
        quantity=f"{model}, {duration:g} s: impacts compared: {len(pairs)}, at least {at_least}",
        obtained=max(at_least - len(pairs), 0),
        tolerance=0.0,
        source="impacts that other joints' impacts do not draw out",
    )
    yield Check(
        quantity=f"{model}: largest error of a restitution",
        obtained=float(np.abs(pairs[:, 0] - pairs[:, 1]).max()),
        tolerance=2e-3,
        source=_SOURCE,
    )
