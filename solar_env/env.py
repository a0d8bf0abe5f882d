"""The Gymnasium environment of one deploying array."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from .array import DEFAULT_ELEMENTS, ArrayParameters, build, check_elements, check_model, main_body_corners
from .integrators import default_integrator
from .ladder import DEFAULT_QUESTION, DEFAULT_TOLERANCE, cheapest, read_answers
from .mechanics import model as m
from .mechanics.geometry import centreline
from .mechanics.joint import ECCENTRICITY_X, ECCENTRICITY_Y, NORMAL
from .mechanics.simulation import Simulation
from .render import Renderer, Scene
from .task import Task, charges, last_latch, observation_entries, observe, wear_depths

Observation = NDArray[np.float32]


class SolarArrayEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """## Description

    A spacecraft's folded solar panels swing open on torsion springs, synchronised by cable loops, latch, and then
    hammer in the clearances of their hinges. A motor on the root hinge adds a torque to the spring's. The task is to
    deploy in time and softly: with little peak force and little wear after latching.

    The physics is that of Li, Wang and Huang, Mech. Syst. Signal Process. 117 (2019) 188-209, simulated with adaptive
    steps between two actions: of 1e-5 to 1e-2 s with rigid panels, of about 1e-5 to 1e-4 s with flexible ones.
    Everything is deterministic; `reset(seed=...)` fixes the draws of `randomize`.

    ## Action Space

    `Box(-1, 1, (1,), float32)`. Values outside are clipped.

    | Num | Action | Min | Max | Unit |
    |-----|--------|-----|-----|------|
    | 0   | Motor torque on the root hinge, positive opens; held for a control period | -1 | 1 | `torque_limit` (N m) |

    ## Observation Space

    `Box` of float32, N panels: what a hinge drive can measure. Values are clipped to the bounds.
    `observation_names` names the entries in order.

    | Num | Observation | Min | Max | Unit |
    |-----|-------------|-----|-----|------|
    | 0 .. N-1   | `theta_i`, joint angle: 0 folded, 1 locked | -2 | 2 | lock angle (pi/2 at the root, else pi rad) |
    | N .. 2N-1  | `rate_i`, its rate | -5 | 5 | rad/s |
    | 2N .. 3N-1 | `latched_i`, latch switch | 0 | 1 | - |
    | 3N   | `motor_torque`, applied in the last period | -1 | 1 | `torque_limit` |
    | 3N+1 | `time_to_deadline` | 0 | 1 | `deadline` (20 s) |
    | 3N+2 | `time_since_latch`, since the last joint latched | 0 | 1 | `postlock_window` (10 s) |

    `observation="privileged"` appends what only a simulator knows, for analysis and bounds:

    | Num | Observation | Min | Max | Unit |
    |-----|-------------|-----|-----|------|
    | 3N+3 .. 6N+2 | by joint: `eccentricity_x_i`, `eccentricity_y_i` (inertial axes) | -2 | 2 | clearance |
    |              | and `in_contact_i` | 0 | 1 | - |
    | 6N+3 | `main_body_spin` | -1 | 1 | rad/s |

    ## Rewards

    The sum of the terms in `info["reward_terms"]`:

    * `peak_impact`: minus the growth, in this step, of the peak force since the first latching, summed over the joints,
      in units of 500 N. Over an episode it adds up to the peaks themselves.
    * `wear`: minus the sliding work (integral of normal force times sliding speed, to which wear is proportional) since
      the first latching, summed over the joints, in units of 0.05 J.
    * `missed_deadline`: -25 if a joint is still open at the deadline, else 0.

    The first two are bounded by 12 each over an episode, so that a missed deadline costs more than the worst
    deployment. The passive deployment (no motor torque) returns about -3.4.

    ## Starting State

    Folded, at rest, journals centred. Parameters are drawn anew from `randomize` at every reset.

    ## Episode End

    * Termination: `postlock_window` after the last latching (the last step is cut to end there), or at the deadline if
      a joint is still open.
    * Truncation: never by itself. With the defaults an episode has at most 300 steps.

    ## Information

    Every step: `time_s` and `reward_terms`. The last step also: `deployment`, the physical figures of the episode
    (`latched`, `latch_times_s`, `peak_postlock_force_N`, `postlock_impulse_Ns`, `postlock_sliding_work_J`,
    `wear_depth_max_m`, `contact_starts`, each a list by joint but the first, `motor_work_J`, `energy_residual_J`,
    `duration_s`).

    ## Arguments

    ```python
    gymnasium.make("solar_env/Deploy-v0", model="rigid-clearance", randomize={"clearance": (5e-5, 5e-4)})
    ```

    * `model`: "rigid-clearance" (default), "rigid-ideal", "flexible-clearance" or "flexible-ideal". With ideal joints
      the joint reactions take the place of contact forces and nothing wears. Flexible panels are beams in the absolute
      nodal coordinate formulation.
      "auto" takes the cheapest model and elements that answer a question, as measured by
      `python -m solar_env ladder` with the default parameters; the attributes `model` and `elements` then say which.
      With other parameters, and with `randomize`, take it as a hint.
    * `elements`: number of beam elements of each flexible panel (6), from 1 to 1000; rigid panels do not use it.
    * `question`, `tolerance`: of `model="auto"`: one of `solar_env.ladder.QUESTIONS` and the error allowed. By default
      at most a fifth of the pairs of controllers may be ranked wrongly ("controller-ranking", 0.2).
    * `parameters`: an `ArrayParameters`, or a mapping of changes to the default ones.
    * `randomize`: mapping of parameter names to (low, high); each reset draws uniformly, by joint where the
      parameter is by joint.
    * `observation`: "drive" (default) or "privileged".
    * `torque_limit`, `control_period`, `deadline`, `postlock_window`: see `solar_env.task.Task`.
    * `render_mode`: "rgb_array" or None.

    `reset(options={"parameters": {...}})` changes parameters for one episode, after `randomize`.

    ## Version History

    * v0: first version.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - declared so by Gymnasium
        "render_modes": ["rgb_array"],
        "render_fps": 10,
    }

    def __init__(
        self,
        model: str = "rigid-clearance",
        parameters: ArrayParameters | Mapping[str, Any] | None = None,
        *,
        elements: int = DEFAULT_ELEMENTS,
        question: str | None = None,
        tolerance: float | None = None,
        torque_limit: float = 0.5,
        control_period: float = 0.1,
        deadline: float = 20.0,
        postlock_window: float = 10.0,
        observation: str = "drive",
        randomize: Mapping[str, tuple[float, float]] | None = None,
        render_mode: str | None = None,
    ) -> None:
        """See the class.

        Raises:
            ValueError: for an unknown name or a refused value; the message says which.
        """
        self.model, self.elements = _level(model, elements, question, tolerance)
        if not isinstance(parameters, ArrayParameters):
            parameters = ArrayParameters().with_changes(parameters or {})
        self.parameters = parameters
        self.task = Task(torque_limit, control_period, deadline, postlock_window)
        self.randomize = _checked_ranges(parameters, randomize or {})
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(f"render_mode {render_mode!r} is unknown; choose rgb_array or None")
        self.render_mode = render_mode
        entries = observation_entries(parameters.panel_count, observation)
        self.observation_names = tuple(entry.name for entry in entries)
        self._privileged = observation == "privileged"
        self._low = np.array([entry.low for entry in entries], dtype=np.float32)
        self._high = np.array([entry.high for entry in entries], dtype=np.float32)
        self.observation_space = gymnasium.spaces.Box(self._low, self._high, dtype=np.float32)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (1,), dtype=np.float32)
        self._simulation: Simulation | None = None
        self._charged = (0.0, 0.0)
        self._ended = True
        self._renderer: Renderer | None = None
        self._peaks: list[NDArray[np.float64]] = []
        self._times: list[float] = []

    @property
    def simulation(self) -> Simulation:
        """The running simulation; its state can be saved and restored between steps.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
        """
        if self._simulation is None:
            raise gymnasium.error.ResetNeeded("call reset() before using the simulation")
        return self._simulation

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Fold the array and draw its parameters.

        Args:
            seed: of the draws; None continues the sequence.
            options: {"parameters": {name: value}} changes parameters for this episode.

        Raises:
            ValueError: for unknown options, parameters or refused values.
        """
        super().reset(seed=seed)
        unknown = set(options or {}) - {"parameters"}
        if unknown:
            raise ValueError(f"reset options {sorted(unknown)} are unknown; the one option is 'parameters'")
        changes = {**self._draw(), **((options or {}).get("parameters") or {})}
        if changes.get("panel_count", self.parameters.panel_count) != self.parameters.panel_count:
            raise ValueError("panel_count shapes the observation space; set it when the environment is made")
        self.episode_parameters = self.parameters.with_changes(changes)
        mechanism = build(self.episode_parameters, self.model, self.elements)
        self._simulation = Simulation(mechanism, default_integrator(self.model))
        self._charged = (0.0, 0.0)
        self._ended = False
        self._renderer = None
        self._peaks, self._times = [np.zeros(self.episode_parameters.panel_count)], [0.0]
        return self._observe(), {"time_s": 0.0, "reward_terms": dict.fromkeys(_TERMS, 0.0)}

    def _draw(self) -> dict[str, Any]:
        drawn: dict[str, Any] = {}
        for name, (low, high) in self.randomize.items():
            if name in ArrayParameters.BY_JOINT:
                drawn[name] = tuple(self.np_random.uniform(low, high, self.parameters.panel_count).tolist())
            else:
                drawn[name] = float(self.np_random.uniform(low, high))
        return drawn

    def step(self, action: Any) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Hold a motor torque for one control period.

        Args:
            action: (1,) motor torque in units of the torque limit; clipped to [-1, 1].

        Raises:
            gymnasium.error.ResetNeeded: before the first reset and after the end of an episode.
            ValueError: if the action has the wrong shape or is not finite.
            SimulationError: if the simulation cannot go on.

        Warns:
            SimulationWarning: if the episode was less accurate than it looks, see ``Simulation.check``.
        """
        if self._ended:
            raise gymnasium.error.ResetNeeded("the episode has ended, or none was begun: call reset()")
        values = np.asarray(action, dtype=np.float64)
        if values.shape != self.action_space.shape:
            raise ValueError(f"action has shape {values.shape}, expected {self.action_space.shape}")
        if not np.isfinite(values[0]):
            raise ValueError(f"action = {values!r} is not finite")
        simulation, task = self.simulation, self.task
        state = simulation.state
        simulation.set_motor_torque(0, task.torque_limit * float(np.clip(values[0], -1.0, 1.0)))
        state.joints["recent_peak_force"] = 0.0
        simulation.advance(self._end_of_step())
        terms, terminated = self._score(state)
        self._ended = terminated
        info: dict[str, Any] = {"time_s": simulation.time, "reward_terms": terms}
        if terminated:
            info["deployment"] = self._figures()
        if self.render_mode is not None:
            self._peaks.append(state.joints["recent_peak_force"].copy())
            self._times.append(simulation.time)
        return self._observe(), sum(terms.values()), terminated, False, info

    def _end_of_step(self) -> float:
        """End of the control period, or of the episode if that comes first [s]."""
        simulation, task = self.simulation, self.task
        # Counted in whole periods, so that rounding does not build up.
        end = (round(simulation.time / task.control_period) + 1) * task.control_period
        latched_at = float(last_latch(simulation.state.joints))
        return min(end, task.deadline if np.isnan(latched_at) else latched_at + task.postlock_window)

    def _score(self, state: m.State) -> tuple[dict[str, float], bool]:
        task = self.task
        peak, wear = charges(state, task.force_scale, task.work_scale, task.largest_charge)
        terms = {
            "peak_impact": self._charged[0] - peak,
            "wear": self._charged[1] - wear,
            "missed_deadline": 0.0,
        }
        self._charged = (peak, wear)
        time, latched_at = self.simulation.time, float(last_latch(state.joints))
        if np.isnan(latched_at):
            missed = time >= task.deadline
            if missed:
                terms["missed_deadline"] = -task.missed_deadline_cost
            return terms, missed
        return terms, time >= latched_at + task.postlock_window

    def _observe(self) -> Observation:
        values = np.empty(len(self.observation_names))
        simulation, task = self.simulation, self.task
        observe(
            simulation.model,
            simulation.state,
            task.torque_limit,
            task.deadline,
            task.postlock_window,
            self._privileged,
            values,
        )
        return np.clip(values.astype(np.float32), self._low, self._high)

    def _figures(self) -> dict[str, Any]:
        simulation = self.simulation
        simulation.check()
        state = simulation.state
        joints = state.joints
        by_joint = m.joint_integrals(state.integrals)
        locked = float(state.clock["latched_joints"][0] > 0)
        return {
            "latched": bool(joints["latched"].all()),
            "latch_times_s": [
                float(t) if own else None for t, own in zip(joints["latch_time"], joints["latched"], strict=True)
            ],
            "peak_postlock_force_N": joints["postlock_peak_force"].tolist(),
            "postlock_impulse_Ns": ((by_joint[:, m.IMPULSE] - joints["lock_impulse"]) * locked).tolist(),
            "postlock_sliding_work_J": ((by_joint[:, m.SLIDING_WORK] - joints["lock_sliding_work"]) * locked).tolist(),
            "wear_depth_max_m": wear_depths(state).tolist(),
            "contact_starts": joints["contact_starts"].tolist(),
            "motor_work_J": float(by_joint[0, m.MOTOR_WORK]),
            "energy_residual_J": simulation.energy_residual(),
            "duration_s": simulation.time,
        }

    def render(self) -> NDArray[np.uint8] | None:
        """Draw the present state; (540, 960, 3) uint8, or None without a render mode."""
        if self.render_mode is None:
            gymnasium.logger.warn(
                'render() does nothing without a render mode; make the environment with render_mode="rgb_array"'
            )
            return None
        scene = self._scene()
        if self._renderer is None:
            task = self.task
            self._renderer = Renderer(self._folded_scene(), task.deadline + task.postlock_window)
        return self._renderer.draw(scene)

    def _folded_scene(self) -> Scene:
        folded = Simulation(build(self.episode_parameters, self.model, self.elements))
        return _scene(folded, self.episode_parameters, [0.0], [np.zeros(self.episode_parameters.panel_count)])

    def _scene(self) -> Scene:
        return _scene(self.simulation, self.episode_parameters, self._times, self._peaks)


_TERMS = ("peak_impact", "wear", "missed_deadline")


def _level(model: str, elements: int, question: str | None, tolerance: float | None) -> tuple[str, int]:
    """Model and elements as given, or chosen by the ladder."""
    if model != "auto":
        if question is not None or tolerance is not None:
            raise ValueError(f"question and tolerance choose the model: they need model='auto', not {model!r}")
        return check_model(model), check_elements(elements)
    if elements != DEFAULT_ELEMENTS:
        raise ValueError(f"model='auto' chooses the elements too: leave out elements = {elements!r}, or name the model")
    chosen = cheapest(
        read_answers(),
        DEFAULT_QUESTION if question is None else question,
        DEFAULT_TOLERANCE if tolerance is None else tolerance,
    )
    return chosen.model, chosen.elements or DEFAULT_ELEMENTS


def _checked_ranges(
    parameters: ArrayParameters, ranges: Mapping[str, tuple[float, float]]
) -> dict[str, tuple[float, float]]:
    """The ranges with both ends shown to be acceptable values."""
    checked = {}
    for name, bounds in ranges.items():
        if np.shape(bounds) != (2,):
            raise ValueError(f"randomize[{name!r}] = {bounds!r} must be a pair (low, high)")
        low, high = float(bounds[0]), float(bounds[1])
        if not low <= high:
            raise ValueError(f"randomize[{name!r}] = {bounds!r} must satisfy low <= high")
        for end in (low, high):
            parameters.with_changes({name: end})
        checked[name] = (low, high)
    return checked


def _scene(
    simulation: Simulation, parameters: ArrayParameters, times: list[float], peaks: list[NDArray[np.float64]]
) -> Scene:
    model, state = simulation.model, simulation.state
    loads = simulation.joint_loads()
    axes = [centreline(model, state.q, body) for body in range(parameters.panel_count + 1)]
    eccentricity = loads[:, [ECCENTRICITY_X, ECCENTRICITY_Y]]
    return Scene(
        time=simulation.time,
        main_body=main_body_corners(parameters, axes[0]),
        panels=tuple(axes[1:]),
        hinges=np.array([panel[0] for panel in axes[1:]]) - eccentricity,
        eccentricity=eccentricity,
        clearance=model.joints["clearance"].copy(),
        journal_radius=model.joints["journal_radius"].copy(),
        in_contact=state.joints["in_contact"].astype(np.bool_),
        normal_force=loads[:, NORMAL].copy(),
        latched=state.joints["latched"].astype(np.bool_),
        motor_torque=float(state.joints["motor_torque"][0]),
        force_times=np.array(times),
        force_history=np.array(peaks),
    )
