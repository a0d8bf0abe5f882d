"""The ladder of model levels: their measured errors and costs, and the cheapest level that is accurate enough.

A question, such as "peak-force", names a computed result. `solar-env ladder` has measured the errors for each question.
"""

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import get_type_hints

from solar_env.support.values import check_name, check_positive

PACKAGED_TABLE = Path(__file__).resolve().parent / "data" / "ladder.csv"

QUESTIONS = {
    "latch-time": "when each joint latches",
    "peak-force": "greatest contact force of each joint after the first latching",
    "wear": "sliding work of each joint after the first latching, to which wear is proportional",
    "impact-count": "number of impacts of each joint after the first latching",
    "impulse": "impulse of each joint's contact force after the first latching",
    "tip-motion": "path of the outermost panel's free end; errors over the length of the array",
    "controller-ranking": "which of two controllers is softer by peak force and by sliding work; errors are shares of "
    "pairs in the wrong order",
}
_ROUNDING = 1.0 + 1e-9  # factor on a tolerance, since a fraction of pairs may equal the tolerance up to rounding
_LARGEST_TOLERANCE = 10.0  # largest tolerance accepted; a greater one was meant in per cent


@dataclass(frozen=True)
class Answer:
    """Error and cost of a model level for one question, which names a computed result such as "peak-force".

    Attributes:
        question, level: a key of QUESTIONS, and the level's name as `ModelLevel.of` takes it.
        error: relative error of the result's mean over an ensemble of simulations, against a reference finer than all
            levels; the greatest among the joints, or for the motion of the array's tip, the greatest at any time. For
            "controller-ranking" it is the fraction of controller pairs in the wrong order.
        half_width: half the width of the error's 95 % sampling band.
        cost_ratio: wall time divided by the wall time of the reference, measured side by side.
        evaluations: mean number of right-hand side evaluations per member of the ensemble.
        members: number of ensemble members.
    """

    question: str
    level: str
    error: float
    half_width: float
    cost_ratio: float
    evaluations: float
    members: int

    @property
    def bound(self) -> float:
        """Upper end of the 95 % band of the model level's relative error against the reference: error + half_width."""
        return self.error + self.half_width


def read_answers(path: Path = PACKAGED_TABLE) -> tuple[Answer, ...]:
    """Read a table (CSV) that `solar-env ladder` wrote, by default the packaged one; return an `Answer` for each row.

    Raises:
        ValueError: if the file cannot be read or is not such a table.
    """
    kinds = get_type_hints(Answer)
    try:
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        rows = csv.DictReader(line for line in lines if not line.startswith("# "))
        answers = tuple(Answer(**{name: kind(row[name]) for name, kind in kinds.items()}) for row in rows)
        if not all(answer.cost_ratio > 0.0 for answer in answers):
            raise ValueError("a cost_ratio is not positive")
    except (OSError, ValueError, TypeError, KeyError, OverflowError, csv.Error) as error:
        raise ValueError(f"{path} is not a table of the ladder ({error}); measure it: solar-env ladder") from error
    return answers


def steps(answers: Iterable[Answer], question: str) -> tuple[Answer, ...]:
    """Return the Pareto-optimal answers to `question`, a key of QUESTIONS: error `bound` rises, `cost_ratio` falls."""
    chosen: list[Answer] = []
    for answer in sorted((a for a in answers if a.question == question), key=lambda a: (a.bound, a.cost_ratio)):
        if not chosen or answer.cost_ratio < chosen[-1].cost_ratio:
            chosen.append(answer)
    return tuple(chosen)


def cheapest(answers: Iterable[Answer], question: str, tolerance: float) -> Answer:
    """Return the `Answer` of the cheapest model level (fidelity) that computes a result to within `tolerance`.

    `question`, a key of QUESTIONS, names the result. The upper end of the error's 95 % band, `Answer.bound`, decides.

    Raises:
        ValueError: if the question is unknown or was not measured, the relative tolerance is not positive or exceeds 10
            (1000 %), or no level is accurate enough.
    """
    check_name("question", question, QUESTIONS)
    check_positive("tolerance", tolerance)
    if tolerance > _LARGEST_TOLERANCE:
        raise ValueError(f"tolerance = {tolerance:g} is {tolerance:,.0%}; give a share, such as 0.2 for 20 %")
    asked = [answer for answer in answers if answer.question == question]
    if not asked:
        raise ValueError(f"the table does not tell of {question!r}; measure it: solar-env ladder")
    within = [answer for answer in asked if answer.bound <= tolerance * _ROUNDING]
    if not within:
        best = min(asked, key=lambda answer: answer.bound)
        raise ValueError(
            f"no level answers {question!r} to a tolerance of {tolerance:g}: the best, {best.level}, is known to "
            f"{best.bound:.3g} (error {best.error:.3g}, sampling {best.half_width:.3g}); allow as much, or name a "
            "level yourself and compare ensembles"
        )
    return min(within, key=lambda answer: answer.cost_ratio)


def cheapest_level(question: str, tolerance: float) -> str:
    """Return the name of the cheapest model level that computes the result `question` within a relative tolerance.

    `question` is a key of QUESTIONS. Errors were measured against a reference that is finer than all levels.
    """
    return cheapest(read_answers(), question, tolerance).level
