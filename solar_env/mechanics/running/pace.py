"""How many steps a compiled call takes before it comes back to Python, where Ctrl-C is heard."""

import time
from typing import Any

# Of a call [s]: its end is the longest that Ctrl-C waits.
_RETURN_WITHIN = 0.2
_FEWEST, _MOST = 16, 1_000_000
_FIRST_RATE = 1e4  # steps per second, before any is measured


def tried_steps(clock: Any) -> int:
    """Steps that a simulation has taken or tried so far."""
    return int(clock["steps"][0] + clock["rejected_steps"][0])


class Pace:
    """Measures how fast steps are taken, and says how many fit into a fifth of a second.

    What a run computes does not depend on it: a call that comes back between two steps goes on to the same bits.
    """

    def __init__(self) -> None:
        self._rate = _FIRST_RATE
        self._began = 0.0
        self._standing = 0

    def begin(self, lanes_in_turn: float = 1.0) -> int:
        """Steps that each lane may take in the call that begins now, if so many lanes take their turn."""
        self._began = time.perf_counter()
        fitting = int(min(max(self._rate * _RETURN_WITHIN / lanes_in_turn, _FEWEST), _MOST))
        return max(fitting, 2 * self._standing)

    def stopped(self, allowed: int, lanes_in_turn: float, time_went_on: bool) -> None:
        """Note that the call has come back for the number of its steps; one that has reached its end tells nothing.

        A call counts events that follow each other without time between them: where time stands, calls become longer
        until one has seen enough of them.

        Args:
            allowed: steps that each lane was allowed to take.
            lanes_in_turn: lanes, of each thread, that have taken as many.
            time_went_on: whether the time of all these lanes did.
        """
        measured = allowed * lanes_in_turn / max(time.perf_counter() - self._began, 1e-9)
        # Lanes that have reached their end have taken steps too, which are not known.
        self._rate = max(measured, 0.5 * self._rate)
        self._standing = 0 if time_went_on else self._standing + allowed
