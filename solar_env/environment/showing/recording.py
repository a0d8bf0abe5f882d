"""Recording of episodes as trajectories, for plots and pages."""

import hashlib
import math
from typing import Any

import gymnasium
import numpy as np

from solar_env.mechanics.records.recording import make_recorder
from solar_env.mechanics.running.trajectory import Trajectory, assemble, contact_table
from solar_env.support.values import check_positive

_CONTACTS = 1000  # initial capacity of the record, in contacts


class RecordTrajectory(gymnasium.Wrapper):
    """A wrapper that records the episode as a `Trajectory`, sampled every `output_step` [s] and at the present time.

    Recording does not change the episode in a single bit. The trajectory is the motion that led to the present state:
    after an earlier state is restored between two steps, the next step discards the later part of the record.

    Raises:
        RuntimeError: from `step` and `trajectory`, if a state was restored that is not in the record.
    """

    def __init__(self, env: gymnasium.Env, output_step: float = 0.005) -> None:
        check_positive("output_step", output_step, " s")
        if not hasattr(env.unwrapped, "episode_parameters"):
            raise ValueError(f"{env} is no environment of a solar array: record one of solar_env")
        super().__init__(env)
        self._step = output_step
        self._moments: list[tuple[bytes, list[int]]] = []  # (digest of a state, [samples, contacts] so far)

    def reset(self, *, seed: int | None = None, options: dict[str, object] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begin an episode, and a new record of its motion."""
        result = super().reset(seed=seed, options=options)
        self._begin()
        return result

    def _begin(self) -> None:
        env: Any = self.unwrapped
        task = env.task
        longest = task.deadline * (1.0 + task.overtime) + task.settling_window + task.control_period
        times = np.arange(math.ceil(longest / self._step)) * self._step
        env._episodes.batch.record(make_recorder(env.simulation.model, env.simulation.state, times, _CONTACTS))
        self._moments = [(self._digest(), [0, 0])]

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        """Take a step and record its motion; if an earlier state was restored, discard the record after that state."""
        if not self._moments:
            return super().step(action)
        env: Any = self.unwrapped
        known, filled, time = self._known(), self._recorder.filled.copy(), env.simulation.time
        self._recorder.filled[:] = self._moments[known - 1][1]
        try:
            return super().step(action)
        finally:  # a failed simulation has also reached a new state
            if env.simulation.time < time:  # an inner wrapper has begun an episode
                self._begin()
            elif env.simulation.time == time:  # the step was refused
                self._recorder.filled[:] = filled
            else:
                self._moments[known:] = [(self._digest(), self._recorder.filled.tolist())]

    @property
    def _recorder(self) -> Any:
        env: Any = self.unwrapped
        return env._episodes.batch.recorder

    def _digest(self) -> bytes:
        env: Any = self.unwrapped
        state = env.simulation.state
        return hashlib.sha256(state.clock["time"].tobytes() + state.q.tobytes() + state.v.tobytes()).digest()

    def _known(self) -> int:
        """Return the number of recorded states up to and including the present state."""
        digests = [digest for digest, _ in self._moments]
        if (present := self._digest()) not in digests:
            raise RuntimeError("the present state was restored and nothing recorded has led to it: call reset()")
        return digests.index(present) + 1

    @property
    def trajectory(self) -> Trajectory:
        """Trajectory of the present episode from the reset to the present state."""
        if len(self._moments) < 2:
            raise gymnasium.error.ResetNeeded("there is nothing recorded yet: call reset() and step()")
        env: Any = self.unwrapped
        simulation, recorder = env.simulation, self._recorder
        samples, contacts = self._moments[self._known() - 1][1]
        present = make_recorder(simulation.model, simulation.state, np.array([simulation.time]), 0)
        simulation.advance(simulation.time, present)
        samples -= samples > 0 and recorder.times[samples - 1] == simulation.time
        kept = recorder._replace(
            times=np.append(recorder.times[:samples], present.times),
            samples=np.concatenate([recorder.samples[:samples], present.samples]),
        )
        details = {
            "model": env.model,
            "parameters": env.episode_parameters.to_dict(),
            "integrator": simulation.integrator.name,
        }
        table = contact_table(simulation.state, recorder.contacts[:contacts])
        return assemble(simulation.model, simulation.state, kept, table, details)
