"""Tables of the measured step rates, in Markdown."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from solar_env.mechanics.running.batch import available_processors
from solar_env.studies.throughput import step_rates as measured
from solar_env.support.markdown import markdown_table


def _table(title: str, columns: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    return [f"{title}:", "", markdown_table(columns, rows), ""]


def tables(results: Mapping[measured.Key, Any]) -> str:
    """The results of `step_rates.measurements`: rates by lanes, where a step's time goes, and peers."""
    models = list(dict.fromkeys(model for _, model, _ in results))
    threads = available_processors()
    lines = _table(
        f"Environment steps (0.1 s) per second, {threads} threads, by number of lanes",
        ("model", *map(str, measured.LANES), f"{threads} threads over 1 ({measured.SCALED_LANES} lanes)"),
        (
            (
                model,
                *(f"{results['lanes', model, lanes].rate:,.0f}" for lanes in measured.LANES),
                f"{results['threads', model, '']:.2f}",
            )
            for model in models
        ),
    )
    splits = {model: results["lanes", model, measured.SCALED_LANES] for model in models}
    lines += _table(
        f"Where a step's time goes, {measured.SCALED_LANES} lanes",
        ("model", "a lane's step [us]", "physics", "observation and reward", "Python"),
        (
            (
                model,
                f"{split.wall / split.steps * 1e6:,.0f}",
                *(f"{share / split.wall:.1%}" for share in (split.physics, split.observation, split.python)),
            )
            for model, split in splits.items()
        ),
    )
    lines += _table(
        f"Against other vectors of {measured.COMPARED_LANES} environments (ratio of steps per second), "
        "memory and start-up",
        ("model", *(f"over {peer}" for peer in measured.PEERS), "memory a lane [kB]", "start-up, cached [s]"),
        (
            (
                model,
                *(f"{results['peers', model, ''][peer]:.2f}" for peer in measured.PEERS),
                f"{results['memory', model, ''] / 1e3:,.0f}",
                f"{results['startup', model, 'cached']:.1f}",
            )
            for model in models
        ),
    )
    cold = [value for (what, _, of), value in results.items() if (what, of) == ("startup", "cold")]
    if cold:
        return "\n".join([*lines, f"Start-up with an empty cache, which compiles the kernels: {cold[0]:.0f} s."])
    return "\n".join(lines[:-1])
