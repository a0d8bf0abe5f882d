"""Episodes kept as trajectories, for plots and pages."""

import math
from typing import Any

import gymnasium
import numpy as np

from solar_env.mechanics.records.recording import Recorder, make_recorder
from solar_env.mechanics.running.trajectory import Trajectory, assemble, contact_table

_CONTACTS = 100_000  # of an episode, at most


class RecordTrajectory(gymnasium.Wrapper):
    """Keep the present episode of an environment, with samples every `output_step` [s], as a `Trajectory`.

    The episode stays the same to the bit.
    """

    def __init__(self, env: gymnasium.Env, output_step: float = 0.005) -> None:
        if not 0.0 < output_step < math.inf:
            raise ValueError(f"output_step = {output_step!r} s must be positive and finite")
        super().__init__(env)
        self._step = output_step
        self._recorder: Recorder | None = None

    def reset(self, *, seed: int | None = None, options: dict[str, object] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begin an episode, and its record."""
        result = super().reset(seed=seed, options=options)
        env: Any = self.unwrapped
        task = env.task
        longest = task.deadline * (1.0 + task.overtime) + task.settling_window + task.control_period
        times = np.arange(math.ceil(longest / self._step)) * self._step
        self._recorder = make_recorder(env.simulation.model, env.simulation.state, times, _CONTACTS)
        env._episodes.batch.record(self._recorder)
        return result

    @property
    def trajectory(self) -> Trajectory:
        """The episode so far."""
        env: Any = self.unwrapped
        if self._recorder is None or self._recorder.filled[0] == 0:
            raise gymnasium.error.ResetNeeded("there is nothing recorded yet: call reset() and step()")
        simulation, (samples, contacts) = env.simulation, self._recorder.filled.tolist()
        kept = self._recorder._replace(times=self._recorder.times[:samples], samples=self._recorder.samples[:samples])
        details = {
            "model": env.model,
            "parameters": env.episode_parameters.to_dict(),
            "integrator": simulation.integrator.name,
        }
        table = contact_table(simulation.state, kept.contacts[:contacts])
        return assemble(simulation.model, simulation.state, kept, table, details)
