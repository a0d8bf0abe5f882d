"""The Gymnasium environment of one deploying array."""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray

from solar_env.array import ArrayParameters
from solar_env.environment.episodes import Episodes, Info, checked_actions, raise_first
from solar_env.environment.settings import RENDER_MODES, EnvironmentSettings
from solar_env.environment.showing.window import Window
from solar_env.environment.task.observations import observation_table
from solar_env.environment.task.reward import reward_table
from solar_env.mechanics.running.simulation import Simulation

Observation = NDArray[np.float32]


class SolarArrayEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """## Description

    Torsion springs open a spacecraft's folded solar panels, and cable loops synchronise the hinges. The hinges latch,
    and their journals then hammer in the clearances. A drive on one hinge, by default the root hinge, works with or
    against the springs. The task is to deploy in time and softly: with low peak force after latching, and little wear.

    The physics follows Li, Wang and Huang, Mech. Syst. Signal Process. 117 (2019) 188-209. Between two actions the
    simulation takes adaptive steps: 1e-5 to 1e-2 s with rigid panels, 1e-5 to 3e-3 s with flexible panels.
    Everything is deterministic; `reset(seed=...)` fixes the samples of `randomize` and the noise.

    | Quantity | Keyword | Value |
    |----------|---------|-------|
    | time between two actions | `control_period` | 0.5 s |
    | time by which every joint should have latched | `deadline` | 20 s |
    | end of an episode in which a joint stays open | | 40 s, twice the deadline |
    | time from the last latching to the end of the episode | `settling_window` | 10 s |
    | greatest motor torque | `torque_limit` | 1 N m; other arrays and joints scale this with the springs' load |

    ## Action Space

    `Box(-1, 1, (1,), float32)`. Values outside are clipped.

    | Num | Action | Min | Max | Unit |
    |-----|--------|-----|-----|------|
    | 0   | command of the driven hinge's opening rate, on the scale defined below | -1 | 1 | - |

    The drive's rate setpoint is 0.098 exp(u) rad/s for negative u and 0.098 (1 + 0.05 u) rad/s for positive u, where u
    follows 4.5 times the action with a lag of 5 s. An action of 0 deploys the array unhurriedly: 0.098 rad/s opens the
    hinge in 0.8 of the deadline. An action of -1 slows the hinge down to a ninetieth of that rate.

    A feedback loop holds the setpoint. With rigid panels it sets the motor torque 20 times a second to 25 N m s/rad
    times the rate error. That gain would shake flexible panels; theirs is 12 N m s/rad, 100 times a second. A light
    driven panel, such as a yoke, gets more samples a second. The loop subtracts the springs' torque, found
    with parameters before random sampling. The torque stays within the limit and passes a low-pass filter of 0.1 s. The
    setpoint changes by at most 0.05 rad/s^2. The keyword `hardware` changes the loop; arrays of four or more panels
    need a greater `rate_loop_gain`. After the last latching the drive alone brings the array to rest with a setpoint
    of 0; the step of that latching lasts until the episode ends.

    With `action="torque"` an action is the motor torque divided by the limit; positive torques open the hinge. With
    several driven joints, such as `driven_joint=(0, 1)`, each has a motor, a loop and an entry of the action, in order.

    ## Observation Space

    `Box` of float32. Values are clipped to the bounds; `observation_names` names the entries in order. The keyword
    `observation` lists the observables; `_i` stands for one entry per joint, from 1 at the root. The keyword `hardware`
    sets the imperfections of the sensors. These are all observables:

    <observables>

    * "scaled" is the default: distances to the locks and opening rates, latch switches, time, and the setpoint.
      Distances and rates have asinh scales, which resolve the small values shortly before a latching.
    * "drive" observes what a hinge drive can measure: `theta_i`, `rate_i`, `latched_i`, `motor_torque`,
      `time_to_deadline`, `time_since_latch`.
    * "history" extends "drive" by the angles, rates and motor torque observed one, two and three periods ago
      (`theta_1_1_ago`, ...); before the first step the past values equal the first ones.
    * "privileged" extends "drive" by quantities that only a simulator knows, for analysis and bounds:
      `eccentricity_x_i`, `eccentricity_y_i` (inertial axes) and `in_contact_i` joint by joint, and `main_body_spin`.

    ## Rewards

    The reward is the sum of the terms in `info["reward_terms"]`. Each term charges a physical quantity, the "figure":
    in each step it is minus the growth of the figure's cost. With x = `min(figure / scale, bound)` the cost is
    `weight * x`, or `weight * log10(1 + x)` in the form "decades". Over an episode a term adds up to minus the final
    cost. The keyword `reward` changes weights, scales, bounds and forms; terms of weight 0 are left out. All terms:

    <terms>

    Forces and sliding work are summed over the joints, and spins are read at the ends of the control periods. The
    motor's work counts whether the motor drives or brakes. An array that latches after t seconds returns

        3.2 - log10(1 + F / 1 N) - 2 log10(1 + W / 1 mJ) - 0.01 t - 2 max(0, t - 19.5),

    where F is the peak force and W the sliding work: a tenfold F costs 1, a tenfold W costs 2. Time costs more from
    one control period before the deadline on, here from 19.5 s. The term `opening` earns the 3.2 step by step. If a
    joint is still open at 40 s, t is 40, and a further 12 to 24 is charged, according to the joints' mean distance to
    the lock. This exceeds the greatest cost of F and W together, which is 10; a changed `reward` without such an
    excess is refused.

    With rigid panels the springs alone return -4.0. The best constant action, 0, returns -2.4. PPO of Stable-Baselines3
    with its defaults returns -0.6 to -0.1 after 100,000 steps, and 0.7 to 1.0 after a search over the last layer of its
    policy. Of the tuned torque laws, the PD controller returns -0.18, and the velocity-profile servo 0.87.

    ## Starting State

    The array is folded, at rest unless the parameters say otherwise, with centred journals. Every reset samples the
    parameters of `randomize` anew. Springs, clearances and initial rates are sampled separately for every joint, other
    parameters only if their bounds are given by joint.

    ## Episode End

    * Termination: `settling_window` after the last latching, in the step of that latching, or at twice the deadline if
      a joint is still open.
    * Truncation: never by itself. With the defaults an episode has at most 80 steps, at most 40 if it deploys in time.

    In version 1 of the task, `solar_env/Deploy-v1`, the action is a torque, the control period 0.1 s and the torque
    limit 0.5 N m. The episode ends at the deadline, the agent settles the array, and force and work cost linearly.

    ## Information

    Every step has `time_s` and `reward_terms`. The last step also has `deployment`, the results of the episode. Results
    of the array are `latched`, `motor_work_J`, `energy_residual_J`, `duration_s`, and `v1_return`, the return of the
    same deployment by the rewards of version 1. Lists by joint are `latch_times_s`, `peak_latch_torque_Nm`,
    `peak_prelatch_force_N`, `peak_postlock_force_N`, `sliding_work_J`, `postlock_impulse_Ns`,
    `postlock_sliding_work_J`, `wear_depth_max_m` and `contact_starts`.

    ## Arguments

    `solar_env.environment.settings.EnvironmentSettings` describes the keywords: `model`, `parameters`, `version`,
    `torque_limit`, `control_period`, `deadline`, `settling_window`, `driven_joint`, `action`, `observation`, `reward`,
    `scenario`, `randomize`, `hardware`, `render_mode` and `max_steps`.

    `reset(options={"parameters": {...}})` changes parameters for one episode, after `randomize`. It cannot change
    `panel_count`, `wings`, `body_fixed` and `wear_bins`, on which the mechanism's structure depends.
    """

    metadata: dict[str, Any] = {"render_modes": list(RENDER_MODES), "render_fps": 10}  # noqa: RUF012 - as Gymnasium's

    def __init__(self, **keywords: object) -> None:
        """Check the keywords, which the class describes, and prepare the environment.

        Raises:
            TypeError: for an unknown keyword.
            ValueError: for an unknown name or a refused value; the message says which.
        """
        settings = EnvironmentSettings.of(keywords)
        self.render_mode, self.scenario = settings.render_mode, settings.scenario
        self.metadata = {**self.metadata, "render_fps": settings.frames_per_second}
        self.model = str(settings.level)
        self.parameters, self.randomize, self.hardware = settings.array, settings.ranges, settings.devices
        self.task, self.reward, self.observation_names = settings.task, settings.terms, settings.observation_names
        self.observation_space, self.action_space = settings.observation_space(), settings.action_space()
        self._episodes = Episodes([settings])
        self._lane = np.zeros(1, dtype=np.int64)
        self._window = Window(1.0 / self.task.control_period) if self.render_mode == "human" else None

    @property
    def simulation(self) -> Simulation:
        """Simulation of the present episode; the simulation's state can be saved and restored between steps."""
        return self._episodes.batch.simulations[0]

    @property
    def episode_parameters(self) -> ArrayParameters:
        """Array parameters of the present episode, after random sampling and the changes by reset options."""
        return self._episodes.parameters[0]

    def futures(self, lanes: int, threads: int | None = None) -> Episodes:
        """Return `Episodes` of `lanes` environments that continue the present episode; `Episodes.futures` says more."""
        return self._episodes.futures(0, lanes, threads)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, Info]:
        """Begin an episode with a folded array and newly sampled parameters.

        The option {"parameters": {name: value}} changes parameters for this episode.

        Raises:
            ValueError: for unknown options or parameters, or refused values; the present episode then continues.
        """
        settings = self._episodes.settings
        changes = [settings.check_options(options, "parameters").get("parameters", {})]
        with self._episodes.alone():
            settings.check_changes(changes[0])
            super().reset(seed=seed)
            self._episodes.reset(self._lane, [self.np_random], changes)
            if self._window:
                self._window.show(self._episodes.render(0))
            return self._episodes.observations[0].copy(), self._episodes.info(0)

    def step(self, action: ArrayLike) -> tuple[Observation, float, bool, bool, Info]:
        """Advance by one control period with a constant action (motors,), which is clipped to [-1, 1].

        Raises:
            gymnasium.error.ResetNeeded: before the first reset and after the end of an episode.
            ValueError: if the action has the wrong shape, is not finite, or is no number.
            SimulationError: if the simulation cannot continue, or takes more than `max_steps` integration steps.
            RuntimeError: if another thread is in a call to this environment.

        Warns:
            SimulationWarning: if the episode's simulation may be inaccurate, see `Simulation.check`.
        """
        episodes, actions = self._episodes, checked_actions(action, (len(self.task.driven_joints),))
        with episodes.alone():
            if episodes.terminated[0]:
                raise gymnasium.error.ResetNeeded(f"the episode ended at {self.simulation.time:g} s: call reset()")
            raise_first(episodes.attempt(self._lane, actions[np.newaxis]))
            terminated, info = bool(episodes.terminated[0]), episodes.info(0)
            if terminated:
                info["deployment"] = episodes.figures(0)
            if self._window:
                self._window.show(episodes.render(0))
            return episodes.observations[0].copy(), float(episodes.rewards[0]), terminated, False, info

    def render(self) -> NDArray[np.uint8] | None:
        """Draw the present state as a frame (540, 960, 3) uint8; return None without the render mode "rgb_array".

        In the render mode "human" every reset and step shows the frame in a window, one frame per control period.
        """
        return None if self._window else self._episodes.render(0)

    def close(self) -> None:
        """Close the window of the render mode "human", if there is one."""
        if self._window:
            self._window.close()


SolarArrayEnv.__doc__ = (
    (SolarArrayEnv.__doc__ or "")
    .replace("<observables>", observation_table().replace("\n", "\n    "))
    .replace("<terms>", reward_table().replace("\n", "\n    "))
)
