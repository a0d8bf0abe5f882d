"""Cases of the impacts inside a deployment at default settings, each beside the same impact at a tight tolerance.

Deployments with clearance are chaotic: two runs soon have different impacts. Here each impact of the default run is
solved a second time from the very state in which it began. With rigid panels and with beam elements the second run is
explicit. With modal panels it takes the same method at a hundredth of the tolerance and shows the error of its steps
alone: closed forms of the impact are in the cases `restitution`, `modal-struck-bar` and `modal-struck-beam`.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, build
from solar_env.array.methods import default_integrator
from solar_env.mechanics.arrays.model import State
from solar_env.mechanics.integrators.settings import Integrator, RungeKutta
from solar_env.mechanics.joints.joint import penetration
from solar_env.mechanics.modal.arrays import DEPTH, DEPTH_RATE, OTHER, ModalModel, ModalState
from solar_env.mechanics.modal.formulation import present_motion
from solar_env.mechanics.records.history import IMPACT_DURATIONS
from solar_env.mechanics.records.recording import make_recorder
from solar_env.mechanics.running.simulation import Simulation
from solar_env.verification.checks import Check

_ALONE = "impacts that other joints' impacts do not draw out"
_CHUNK = 0.01  # s, which a run and its repetition up to an impact may share before chaos parts them
_AFTER_START = 1e-9  # s
_CORRECTIONS = 4  # by Newton's method of the moment at which surfaces part
_MOST_CONTACTS = 4096  # of a chunk or of one impact
_STEPS_PER_IMPACT = 40.0  # of the tight runs
# Modal panels give way in an impact: it lasts some 35 times as long as that of a panel at the start of its deformation,
# which the prediction is of. Contacts longer than this many predicted durations, 8 ms, are no impacts.
_LONGEST_MODAL = 100.0
_FAST = 0.01  # m/s: impacts from here on have the peak forces
_EXPLICIT = "the same impact from the same state, rtol 1e-10, 40 steps an impact"
_TIGHTER = "the same impact from the same state and by the same method, a hundredth of rtol, 40 steps an impact"


class Impacts(NamedTuple):
    """Impacts of a deployment: speed [m/s] at the start, speed at the end and time [s] until then of both runs."""

    speed: NDArray[np.float64]
    exit_speed: NDArray[np.float64]
    length: NDArray[np.float64]
    tight_exit_speed: NDArray[np.float64]
    tight_length: NDArray[np.float64]

    @property
    def errors(self) -> NDArray[np.float64]:
        """Errors of the exit speeds [m/s]."""
        return np.abs(self.exit_speed - self.tight_exit_speed)

    @property
    def same_end(self) -> NDArray[np.bool_]:
        """Whether both runs end at the same parting: steps pass over gaps of less than a nanometre."""
        return np.abs(self.length - self.tight_length) < 0.1 * self.tight_length

    def where(self, chosen: NDArray[np.bool_]) -> Self:
        """Some of the impacts."""
        return type(self)(*(column[chosen] for column in self))


def _contacts(simulation: Simulation, end_time: float) -> list[tuple[float, int, float]]:
    """Advance, and return start [s], joint and end [s] of the contacts on the way; the end of an open one is nan."""
    recorder = make_recorder(simulation.model, simulation.state, np.zeros(0), _MOST_CONTACTS)
    simulation.advance(end_time, recorder)
    rows = recorder.contacts[: recorder.filled[1]]
    ended = [(float(start), int(joint), float(end)) for joint, start, end in rows[:, :3]]
    own = simulation.state.joints
    return ended + [(float(own["contact_start"][j]), int(j), np.nan) for j in np.flatnonzero(own["in_contact"])]


def _depth(simulation: Simulation, j: int) -> tuple[float, float]:
    """Depth [m] of the contact of joint `j`, negative for a gap, and its rate [m/s]."""
    model, state = simulation.model, simulation.state
    if isinstance(model, ModalModel):
        motion = present_motion(model, state).joints["motion"][j, OTHER]
        return float(motion[DEPTH]), float(motion[DEPTH_RATE])
    depth, rate = penetration(model.joints[j], model.markers, state.q, state.v)
    return float(depth), float(rate)


def _exit(simulation: Simulation, start: State | ModalState, j: int, longest: float) -> tuple[float, ...]:
    """Speed [m/s] and time [s] at which the contact of joint `j` that has just begun ends; none if it lasts longer."""
    begun, duration = float(start.joints[j]["contact_start"]), float(start.joints[j]["contact_duration"])
    simulation.restore(start)
    # Nothing but the method sets the steps up to the end, which is known afterwards: a linear estimate, made better.
    contacts = _contacts(simulation, begun + longest * duration)
    end = next(end for other_start, joint, end in contacts if (other_start, joint) == (begun, j))
    depth, rate = 0.0, -1.0
    for _ in range(_CORRECTIONS):
        if not begun < end < begun + longest * duration:
            return ()
        simulation.restore(start)
        simulation.advance(end)
        depth, rate = _depth(simulation, j)
        end -= depth / rate
    return -rate, simulation.time - begun


def impacts(model: str, duration: float, tight: Integrator, longest: float = IMPACT_DURATIONS) -> Impacts:
    """Impacts of a deployment by the default method, each of them also by another one.

    The exit speed contains what other joints' impacts and the springs do meanwhile, and can exceed the impact speed.

    Args:
        model: its level.
        duration: [s].
        tight: method of the second run of each impact, of the formulation of the default one.
        longest: in predicted durations; contacts that last longer are left out.
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
            run.advance(begun + _AFTER_START)
            start = run.snapshot()
            own = start.joints[j]
            # At the minimum impact speed it is a journal that leans on its bearing.
            if own["in_contact"] and own["impact_speed"] > run.model.joints[j]["minimum_impact_speed"]:
                ends = [_exit(simulation, start, j, longest) for simulation in (run, tight_run)]
                if all(ends):
                    rows.append((float(own["impact_speed"]), *ends[0], *ends[1]))
        run.restore(after)
    return Impacts(*np.array(rows).T)


def _compared(name: str, duration: float, found: Impacts, at_least: int) -> Iterator[Check]:
    """Whether there are enough impacts that end alike in both runs."""
    number = int(found.same_end.sum())
    obtained = max(at_least - number, 0)
    yield Check(f"{name}, {duration:g} s: impacts compared: {number}, at least {at_least}", 0.0, obtained, 0.0, _ALONE)
    left_out = 1.0 - number / found.speed.size
    quantity = f"{name}: share of the impacts left out, which part for a moment in one of the two runs alone"
    yield Check(quantity, 0.0, left_out, 0.01, "gaps below a nanometre")


def deployment_impacts(model: str, duration: float, at_least: int) -> Iterator[Check]:
    """Impacts with rigid panels or beam elements up to a duration [s], of which at least so many can be compared."""
    found = impacts(model, duration, RungeKutta(rtol=1e-10, impact_resolution=_STEPS_PER_IMPACT))
    yield from _compared(model, duration, found, at_least)
    same = found.where(found.same_end)
    yield Check(f"{model}: largest error of a restitution", 0.0, (same.errors / same.speed).max(), 4e-3, _EXPLICIT)


def modal_impacts(duration: float, at_least: int) -> Iterator[Check]:
    """Impacts with modal panels up to a duration [s], of which at least so many can be compared.

    The method's tolerance is one of speeds, here 0.1 mm/s: restitutions of slow impacts are less accurate.
    """
    model = "flexible-clearance"
    name, default = f"{model}, 32 modes a panel", default_integrator(model)
    tight = replace(default, rtol=0.01 * default.rtol, impact_resolution=_STEPS_PER_IMPACT)
    found = impacts(model, duration, tight, _LONGEST_MODAL)
    yield from _compared(name, duration, found, at_least)
    same = found.where(found.same_end)
    errors = same.errors / same.speed
    for quantity, obtained, tolerance in (
        ("median error of a restitution", np.median(errors), 2e-3),
        ("share of restitutions off by more than 1 %", np.mean(errors > 0.01), 0.2),
        ("largest error of a restitution", errors.max(), 0.1),
        (f"largest error of one, from {_FAST:g} m/s on", errors[same.speed >= _FAST].max(), 3e-3),
        ("largest error of an exit speed [m/s]", same.errors.max(), 3.0 * default.rtol * default.velocity_scale),
    ):
        yield Check(f"{name}: {quantity}", 0.0, float(obtained), tolerance, _TIGHTER)
