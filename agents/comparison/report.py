"""A comparison of controllers as numbers, as tables in Markdown, and as files."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from agents.comparison.statistics import Estimate, difference, estimate, improvement, interquartile_mean
from agents.laws.table import LAWS
from agents.learning import runs
from solar_env.studies.common.bootstrap import FEWEST
from solar_env.studies.common.tables import write_table
from solar_env.support.files import make_folder, write_text
from solar_env.support.markdown import markdown_table
from solar_env.support.versions import versions

# Quantity of an episode -> (heading, factor to the heading's unit). Tables show these; the CSV file has all.
TABLE: dict[str, tuple[str, float]] = {
    "return": ("return", 1.0),
    "v1_return": ("return at the prices of v1", 1.0),
    "peak_latch_torque_Nm": ("latch torque [N m]", 1.0),
    "peak_postlock_force_N": ("peak post-lock force [N]", 1.0),
    "peak_prelatch_force_N": ("peak force before latching [N]", 1.0),
    "sliding_work_J": ("sliding work [mJ]", 1e3),
    "wear_depth_max_m": ("largest wear depth [1e-15 m]", 1e15),
    "latch_times_s": ("last latch [s]", 1.0),
}
TABLES = "comparison.md"  # file with the tables of an evaluation
HIGHER_IS_BETTER = frozenset({"return", "v1_return"})

Row = dict[str, Any]
Entry = dict[str, Any]  # entry of a controller: estimates, number of runs, fraction of latched episodes
Summary = dict[str, Entry]


def summarize(rows: Sequence[Row]) -> Summary:
    """Summarize rows by controller: latched fraction, estimates of the quantities in `TABLE`, comparison of returns.

    The comparison with the controller `reference(rows)` pairs episodes with the same seed. The entry "above" is the
    difference of the returns, "better" the probability of a higher return.
    """
    by_run: dict[str, dict[str, list[Row]]] = {}
    for row in sorted(rows, key=lambda row: row["episode"]):
        by_run.setdefault(row["controller"], {}).setdefault(row["spec"], []).append(row)
    base = _values(by_run[reference(rows)], "return")
    summary: Summary = {}
    for name in dict.fromkeys(row["controller"] for row in rows):
        mine = [row for run in by_run[name].values() for row in run]
        entry: Entry = {"runs": len(by_run[name]), "latched": sum(r["latched"] for r in mine) / len(mine)}
        entry |= {figure: estimate(_values(by_run[name], figure)) for figure in TABLE if figure in mine[0]}
        returns = _values(by_run[name], "return")
        summary[name] = entry | {"above": difference(returns, base), "better": improvement(returns, base)}
    return summary


def _values(by_run: Mapping[str, Sequence[Row]], figure: str) -> list[np.ndarray]:
    """Return the values (episodes,) of the quantity named `figure`, one array for each run."""
    return [np.array([row[figure] for row in run]) for run in by_run.values()]


def reference(rows: Sequence[Row]) -> str:
    """Name the controller to compare with: the torque law of highest mean return, or without laws the first one."""
    returns = {
        name: float(interquartile_mean(np.array([row["return"] for row in rows if row["controller"] == name])))
        for name in dict.fromkeys(row["controller"] for row in rows if row["spec"] in LAWS)
    }
    return max(returns, key=returns.__getitem__, default=rows[0]["controller"])


def tabulate(rows: Sequence[Row], summary: Summary | None = None) -> str:
    """Format a comparison as a table in Markdown with an explanation; `summary` defaults to the summary of `rows`."""
    summary = summarize(rows) if summary is None else summary
    figures = [figure for figure in TABLE if figure in next(iter(summary.values()))]
    other = reference(rows)
    head = ["controller", "latched", *(TABLE[figure][0] for figure in figures), f"return above {other}", "better in"]
    lines = []
    for name, entry in summary.items():
        label = f"{name} ({entry['runs']} runs)" if entry["runs"] > 1 else name
        compared = [with_interval(entry["above"], "{:.3g}"), with_interval(entry["better"], "{:.0%}")]
        cells = [*(_cell(entry[figure], figure) for figure in figures), *(["", ""] if name == other else compared)]
        lines.append([label, f"{entry['latched']:.0%}", *cells])
    told = (
        f"Interquartile mean over evaluation episodes ({len({row['episode'] for row in rows})}), the same for every "
        f"controller, with a 95 % bootstrap interval from {FEWEST} values on, and the worst episode. Post-lock figures "
        f"count deployments that latched. The returns of {other} and of each controller are compared by episode."
    )
    return f"{told}\n\n{markdown_table(head, lines)}\n"


def _cell(value: Estimate, figure: str) -> str:
    if value.count == 0:
        return "-"
    factor = TABLE[figure][1]
    text = with_interval(value, "{:.4g}", factor)
    extreme = value.minimum if figure in HIGHER_IS_BETTER else value.maximum
    return text + (f"; worst {extreme * factor:.4g}" if value.count > 1 else "")


def with_interval(value: Estimate, form: str, factor: float = 1.0) -> str:
    """Format mean * factor by `form`, such as "{:.3g}"; append the interval if there are at least `FEWEST` values."""
    text = form.format(value.mean * factor)
    if value.count < FEWEST:
        return text
    return f"{text} [{form.format(value.lower * factor)}, {form.format(value.upper * factor)}]"


def write_comparison(folder: Path, rows: Sequence[Row], settings: Mapping[str, object]) -> tuple[Summary, str]:
    """Write episodes.csv, metrics.json, comparison.md to `folder`; return (each controller's means, Markdown text)."""
    columns = list(dict.fromkeys(column for row in rows for column in row))
    make_folder(folder)
    write_table(folder / "episodes.csv", [dict.fromkeys(columns, "") | row for row in rows], {})
    summary = summarize(rows)
    tables = tabulate(rows, summary)
    controllers = {name: {key: _plain(value) for key, value in entry.items()} for name, entry in summary.items()}
    content = {"settings": settings, "versions": versions(*runs.LIBRARIES), "controllers": controllers}
    runs.write_json(folder / "metrics.json", content)
    write_text(folder / TABLES, tables)
    return summary, tables


def _plain(value: object) -> object:
    """Convert a value for JSON: an `Estimate` to a dictionary, and NaN to None.

    The ends of an estimate's confidence interval become None if the estimate rests on fewer than `FEWEST` values.
    """
    if isinstance(value, Estimate):
        few = dict.fromkeys(("lower", "upper"), math.nan) if value.count < FEWEST else {}
        return {key: _plain(v) for key, v in (asdict(value) | few).items()}
    return None if isinstance(value, float) and math.isnan(value) else value
