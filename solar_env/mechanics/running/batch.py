"""Batch of mechanisms with the same structure, advanced together on all cores in one compiled call per thread."""

import math
import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cached_property
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.lanes import allocate_lanes, check_structure, copied, fill_lane, lane_view
from solar_env.mechanics.integrators.methods.table import method_of
from solar_env.mechanics.integrators.run import advance_lanes
from solar_env.mechanics.numerics.by_address import address_of
from solar_env.mechanics.numerics.handles import Handle
from solar_env.mechanics.records.recording import Recorder, make_recorder, with_more_room
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import STEPS_BETWEEN_LOOKS, STEPS_PER_CALL, Simulation

_WORK_FOR_A_THREAD = 1e-4  # s, least work that each thread must have: waking a thread takes about as long
_FEWEST_STEPS_PER_CALL = 1100  # fewest steps of a lane: more than the events at once after which a call gives up


class Batch:
    """Batch of simulations, called lanes, whose arrays lie side by side.

    Threads take lanes from one queue, which starts with the lanes that needed most steps the last time: a few lanes
    full of impacts then do not keep the others waiting. A lane's result does not depend on other lanes, nor on the
    number of threads: it equals the result of its `Simulation` alone, bit for bit.

    Attributes:
        simulations: simulations by lane; they can also be read, saved, restored and advanced singly.
        models, states: arrays of all lanes (`lanes.py`).
        handles: `models` and `states` as kernels take them (`numerics.handles`).
        threads: greatest number of threads that advance lanes at the same time.
        recorder: recorder given to `record`, or the same with a larger table of contacts.
    """

    def __init__(self, simulations: list[Simulation], threads: int | None = None) -> None:
        """Move simulations into a batch.

        Args:
            simulations: simulations with the same integrator, of mechanisms with the same structure.
            threads: number of threads; None takes the number of processors for this process.

        Raises:
            ValueError: if there are no simulations, if integrators or structures of mechanisms differ, or if `threads`
                is not positive.
        """
        if not simulations:
            raise ValueError("a batch needs at least one simulation")
        if threads is not None and threads < 1:
            raise ValueError(f"threads = {threads!r} must be at least 1")
        first = simulations[0]
        # Without the compiler, taking a lane from the queue would not be atomic: use one thread.
        available = 1 if numba.config.DISABLE_JIT else threads or available_processors()
        count = len(simulations)
        self.threads = min(available, count)
        self.integrator = first.integrator
        self.models, self.states = allocate_lanes(first.model, count), allocate_lanes(first.state, count)
        self.handles = Handle(self.models), Handle(self.states)
        method = method_of(first.integrator)
        self._settings = method.convert(first.integrator)
        self.recorder = make_recorder(first.model, first.state, np.zeros(0), 0)
        self._arrays = [Handle(method.arrays(first.model, first.state)) for _ in range(self.threads)]
        self._counter = np.zeros(1, dtype=np.int64)
        self._statuses, self._steps_left = (np.zeros(count, dtype=np.int64) for _ in range(2))
        self._steps, self._last_steps, self._steps_looked = (np.zeros(count, dtype=np.int64) for _ in range(3))
        self._work_expected = math.inf
        self._process = os.getpid()
        self.simulations = list(simulations)
        for lane, simulation in enumerate(simulations):
            self.replace(lane, simulation)

    def __getstate__(self) -> dict[str, object]:
        """Return the attributes for copies and pickles, without the threads and the code address of this process."""
        return {name: value for name, value in vars(self).items() if name not in ("_threads", "address")}

    def __setstate__(self, values: dict[str, object]) -> None:
        """Restore the attributes, and let the copied simulations share memory with the batch's copied arrays."""
        vars(self).update(values)
        for lane, simulation in enumerate(self.simulations):
            simulation.move_to(lane_view(self.models, lane), lane_view(self.states, lane))

    def replace(self, lane: int, simulation: Simulation) -> None:
        """Replace the simulation with index `lane`; the previous simulation keeps a copy of its arrays.

        A simulation whose integrator or mechanism's structure differs from the batch's raises a ValueError.
        """
        if simulation.integrator != self.integrator:
            raise ValueError(f"the batch integrates with {self.integrator}, not with {simulation.integrator}")
        check_structure(self.models, simulation.model)
        check_structure(self.states, simulation.state)
        before = self.simulations[lane]
        if before is not simulation:
            before.move_to(copied(before.model), copied(before.state))
        fill_lane(self.models, lane, simulation.model)
        fill_lane(self.states, lane, simulation.state)
        simulation.move_to(lane_view(self.models, lane), lane_view(self.states, lane))
        self.simulations[lane] = simulation
        self._steps_looked[lane] = self._steps[lane] = simulation.state.clock["steps"][0]
        self._last_steps[lane] = 0

    def record(self, recorder: Recorder) -> None:
        """Record samples and contacts in `recorder` from now on; a batch of several simulations raises a ValueError."""
        if len(self.simulations) != 1:
            raise ValueError(f"a batch of {len(self.simulations)} lanes cannot be recorded; take one of a single lane")
        self.recorder = recorder

    def advance(self, lanes: NDArray[np.int64], end_times: NDArray[np.float64]) -> None:
        """Advance some lanes (simulations of the batch) to their end times; check their accuracy every 10,000 steps.

        Args:
            lanes: (k,) indices of the lanes to advance.
            end_times: (all lanes,) [s]; only the entries of `lanes` are used.

        Raises:
            SimulationError: if a lane cannot go on; a note names the lane. That lane stays at its last accepted step;
                the other lanes have advanced.
            KeyboardInterrupt: within two seconds of Ctrl-C; every lane stays at an accepted step.

        Warns:
            SimulationWarning: as `Simulation.check`.
        """
        failures = self.attempt(lanes, end_times)
        if failures:
            lane, *others = failures
            failures[lane].add_note(f"in lane {lane} of the batch{f', and others in {others}' if others else ''}")
            raise failures[lane]

    def attempt(self, lanes: NDArray[np.int64], end_times: NDArray[np.float64]) -> dict[int, SimulationError]:
        """Advance lanes (simulations) to their end times [s]; return the errors of lanes that cannot go on, by lane."""
        return self.run(advance_lanes, lanes, end_times)

    @cached_property
    def address(self) -> int:
        """Address of the function `advance_lanes`, compiled for this batch's arrays, for calls from compiled code."""
        return address_of(advance_lanes, *self._arguments(0, np.zeros(0, np.int64)), np.zeros(0))

    def run(self, kernel: Callable, lanes: NDArray[np.int64], *further: Any) -> dict[int, SimulationError]:
        """Run a kernel on `lanes` (k,), indices of simulations; return a dictionary from failed lanes to errors.

        The kernel takes the arguments of `advance_lanes` up to and including `statuses`, then the arguments `further`.
        Statuses are DONE before the first call; the kernel sets them. It is called again for lanes that used up the
        steps of one call (TOO_MANY_STEPS) or filled the contact table (PAUSED), up to the integrator's `max_steps`.
        """
        queue = lanes[np.argsort(-self._last_steps[lanes], kind="stable")] if lanes.size > 1 else lanes
        left, clock = self.integrator.max_steps, self.states.clock
        self._statuses[lanes] = m.DONE
        while queue.size and left > 0:
            threads = max(1, int(min(self.threads, queue.size, self._work_expected / _WORK_FOR_A_THREAD)))
            allowed = min(max(STEPS_PER_CALL * threads // queue.size, _FEWEST_STEPS_PER_CALL), left)
            self._steps_left[queue], left = allowed, left - allowed
            self._run_once(kernel, queue, further, threads)
            paused = queue[self._statuses[queue] == m.PAUSED]
            if paused.size:
                self.recorder = with_more_room(self.recorder)
                self._statuses[paused] = m.TOO_MANY_STEPS
            queue = queue[self._statuses[queue] == m.TOO_MANY_STEPS]
        steps = clock["steps"][:, 0]
        np.subtract(steps, self._steps, out=self._last_steps)
        self._steps[:] = steps
        failed = sorted(lanes[self._statuses[lanes] != m.DONE].tolist())
        if queue.size:
            clock["failure_joint"][queue], clock["failure_value"][queue] = -1, self.integrator.max_steps
        for lane in np.flatnonzero(np.abs(steps - self._steps_looked) >= STEPS_BETWEEN_LOOKS):
            self._steps_looked[lane] = steps[lane]
            if lane not in failed:
                self.simulations[lane].check()
        return {lane: self.simulations[lane].failure(int(self._statuses[lane])) for lane in failed}

    def _run_once(self, kernel: Callable, queue: NDArray[np.int64], further: tuple[Any, ...], threads: int) -> None:
        """Call a kernel once in each of `threads` threads, and wait until all calls have returned.

        Each call takes lanes (indices of simulations in the batch) from the shared `queue` until no lane is left.
        `further` holds the kernel's arguments beyond those that `_arguments` returns.
        """
        self._counter[0] = 0
        start = time.perf_counter()
        helpers = [self._pool.submit(kernel, *self._arguments(thread, queue), *further) for thread in range(1, threads)]
        try:
            kernel(*self._arguments(0, queue), *further)
        finally:
            # Wait also on Ctrl-C: the helper threads still work on the states.
            if helpers:
                wait(helpers)
        for helper in helpers:
            helper.result()
        self._work_expected = threads * (time.perf_counter() - start)

    def _arguments(self, thread: int, queue: NDArray[np.int64]) -> tuple[Any, ...]:
        """Return the first nine arguments of `advance_lanes` for a thread and a queue of simulations' indices."""
        return (
            *self.handles,
            self._settings,
            self.recorder,
            self._arrays[thread],
            queue,
            self._counter,
            self._steps_left,
            self._statuses,
        )

    @property
    def _pool(self) -> ThreadPoolExecutor:
        if self._process != os.getpid():
            # Threads do not survive a fork.
            self.__dict__.pop("_threads", None)
            self._process = os.getpid()
        return self._threads

    @cached_property
    def _threads(self) -> ThreadPoolExecutor:
        return ThreadPoolExecutor(max(self.threads - 1, 1), thread_name_prefix="lanes")

    def close(self) -> None:
        """End the batch's threads; a later call that needs threads starts new ones."""
        if "_threads" in self.__dict__:
            self._threads.shutdown()
            del self._threads


def available_processors() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
