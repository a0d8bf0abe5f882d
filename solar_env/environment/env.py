"""The Gymnasium environment of one deploying array."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from solar_env.array import DEFAULT_ELEMENTS, ArrayParameters
from solar_env.environment.episodes import Episodes
from solar_env.environment.hardware import Hardware
from solar_env.environment.scenarios import Ranges
from solar_env.environment.setup import Setup
from solar_env.environment.task import REWARD_TERMS, Task
from solar_env.mechanics.running.simulation import Simulation

Observation = NDArray[np.float32]
RESET_OPTIONS = frozenset({"parameters"})


class SolarArrayEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """## Description

    A spacecraft's folded solar panels swing open on torsion springs, synchronised by cable loops, latch, and then
    hammer in the clearances of their hinges. A motor on the root hinge adds a torque to the spring's. The task is to
    deploy in time and softly: with little peak force and little wear after latching.

    The physics is that of Li, Wang and Huang, Mech. Syst. Signal Process. 117 (2019) 188-209, simulated with adaptive
    steps between two actions: of 1e-5 to 1e-2 s with rigid panels, of 1e-5 to 3e-3 s with flexible ones.
    Everything is deterministic; `reset(seed=...)` fixes the draws of `randomize` and the noise.

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

    `observation="history"` appends angles, rates and motor torque as they were observed one, two and three periods ago
    (`theta_1_1_ago`, ...); before the first step they are the first ones.

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

    Folded, at rest unless the parameters say otherwise, journals centred. Parameters are drawn anew from `randomize` at
    every reset.

    ## Scenarios

    * "nominal" (`solar_env/Deploy-v0`): nothing is drawn, sensors and motor are perfect.
    * "randomised" (`solar_env/DeployRandomised-v0`): clearances of 0.05 to 0.5 mm each, friction of 0.05 to 0.3,
      restitution of 0.7 to 0.95 (law of Flores et al.), springs, cable and panels 10 % softer or stiffer, joints that
      open by up to 0.01 rad/s and a main body that turns by up to 0.005 rad/s at release; noise of 5e-4 rad and
      1e-3 rad/s, an encoder of 13 bits, observations of angles, rates and latches a control period late; a motor that
      lags by 0.1 s and changes its torque by 1 N m/s at most. `solar_env.environment.scenarios` has the numbers.

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
    * `question`, `tolerance`: of `model="auto"`: one of `solar_env.array.ladder.QUESTIONS` and the error allowed. By
      default at most a fifth of the pairs of controllers may be ranked wrongly ("controller-ranking", 0.2).
    * `parameters`: an `ArrayParameters`, or a mapping of changes to those of the scenario.
    * `scenario`: "nominal" (default) or "randomised"; the two keywords that follow change it.
    * `randomize`: mapping of parameter names to (low, high), in place of the scenario's; each reset draws uniformly,
      by joint where the parameter is by joint, and there each bound may be one by joint.
    * `hardware`: a `solar_env.Hardware`, or a mapping of changes to the scenario's: `angle_noise`, `rate_noise`,
      `encoder_resolution`, `sensor_delay`, `motor_lag`, `torque_rate_limit`.
    * `observation`: "drive" (default), "history" or "privileged".
    * `torque_limit`, `control_period`, `deadline`, `postlock_window`: see `solar_env.environment.task.Task`.
    * `render_mode`: "rgb_array" or None.

    `reset(options={"parameters": {...}})` changes parameters for one episode, after `randomize`, but for `panel_count`,
    `body_fixed` and `wear_bins`, on which the mechanism's structure depends.

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
        scenario: str = "nominal",
        randomize: Ranges | None = None,
        hardware: Hardware | Mapping[str, Any] | None = None,
        render_mode: str | None = None,
    ) -> None:
        """See the class.

        Raises:
            ValueError: for an unknown name or a refused value; the message says which.
        """
        task = Task(torque_limit, control_period, deadline, postlock_window)
        self._setup = Setup(
            model, parameters, elements, question, tolerance, task, observation, scenario, randomize, hardware
        )
        self.render_mode = checked_render_mode(render_mode)
        self.metadata = {**self.metadata, "render_fps": 1.0 / task.control_period}
        self.model, self.elements = self._setup.model, self._setup.elements
        self.scenario, self.hardware = scenario, self._setup.hardware
        self.parameters, self.randomize = self._setup.parameters, self._setup.randomize
        self.task, self.observation_names = task, self._setup.observation_names
        self.observation_space = self._setup.observation_space()
        self.action_space = self._setup.action_space()
        self._episodes = Episodes(self._setup, [self.parameters], recorded=render_mode is not None)
        self._lane = np.zeros(1, dtype=np.int64)
        self._action = np.zeros(1)

    @property
    def simulation(self) -> Simulation:
        """The running simulation; its state can be saved and restored between steps.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
        """
        return self._episodes.batch.simulations[0]

    @property
    def episode_parameters(self) -> ArrayParameters:
        """Parameters of the present episode."""
        return self._episodes.parameters[0]

    def futures(self, lanes: int, threads: int | None = None) -> Episodes:
        """Copies of the present episode to try its futures with, lane by lane, while it stays as it is.

        They go on from the exact state with the parameters of the episode, and observe the entries of "drive" with
        perfect sensors; see ``Episodes.futures``.

        Args:
            lanes: number of copies.
            threads: most threads that advance them; by default as many as there are processors for this process.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
            ValueError: if ``lanes`` or ``threads`` is not positive.
        """
        return self._episodes.futures(0, lanes, threads)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Fold the array and draw its parameters.

        Args:
            seed: of the draws and the noise; None continues the sequence.
            options: {"parameters": {name: value}} changes parameters for this episode.

        Raises:
            ValueError: for unknown options, parameters or refused values; the present episode goes on then.
        """
        unknown = set(options or {}) - RESET_OPTIONS
        if unknown:
            raise ValueError(f"reset options {sorted(unknown)} are unknown; the one option is 'parameters'")
        changes = [(options or {}).get("parameters") or {}]
        self._episodes.check_changes(self._lane, changes)
        super().reset(seed=seed)
        self._episodes.reset(self._lane, [self.np_random], changes)
        return self._episodes.observations[0].copy(), first_info()

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
        episodes = self._episodes
        if episodes.terminated[0]:
            raise gymnasium.error.ResetNeeded(f"the episode ended at {self.simulation.time:g} s: call reset()")
        values = np.asarray(action, dtype=np.float64)
        if values.shape != self.action_space.shape:
            raise ValueError(f"action has shape {values.shape}, expected {self.action_space.shape}")
        if not np.isfinite(values[0]):
            raise ValueError(f"action = {values!r} is not finite")
        self._action[0] = values[0]
        episodes.step(self._lane, self._action)
        terms = dict(zip(REWARD_TERMS, episodes.terms[0].tolist(), strict=True))
        terminated = bool(episodes.terminated[0])
        info: dict[str, Any] = {"time_s": self.simulation.time, "reward_terms": terms}
        if terminated:
            info["deployment"] = episodes.figures(0)
        return episodes.observations[0].copy(), sum(terms.values()), terminated, False, info

    def render(self) -> NDArray[np.uint8] | None:
        """Draw the present state; (540, 960, 3) uint8, or None without a render mode."""
        if self.render_mode is None:
            gymnasium.logger.warn(
                'render() does nothing without a render mode; make the environment with render_mode="rgb_array"'
            )
            return None
        return self._episodes.render(0)


def checked_render_mode(render_mode: str | None) -> str | None:
    """Return ``render_mode`` if it is one of the environment's.

    Raises:
        ValueError: otherwise.
    """
    if render_mode not in (None, *SolarArrayEnv.metadata["render_modes"]):
        raise ValueError(f"render_mode {render_mode!r} is unknown; choose rgb_array or None")
    return render_mode


def first_info() -> dict[str, Any]:
    """What a reset tells."""
    return {"time_s": 0.0, "reward_terms": dict.fromkeys(REWARD_TERMS, 0.0)}
