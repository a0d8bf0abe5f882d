"""Report of an ensemble's failed simulations, which are left out; at most a tenth of the runs may fail."""

from collections.abc import Mapping

LARGEST_SHARE = 0.1


def told(failures: Mapping[str, str], runs: int) -> str:
    """Return a sentence on the failures (name of the run -> reason) among `runs` runs; it is empty without failures.

    Raises:
        ValueError: if more than a tenth of the runs failed, because the remaining runs would be a biased sample.
    """
    if not failures:
        return ""
    named = "; ".join(f"{name}: {reason}" for name, reason in failures.items())
    if len(failures) > LARGEST_SHARE * runs:
        raise ValueError(
            f"{len(failures)} of {runs} runs failed, more than the {LARGEST_SHARE:.0%} that may be left out ({named})"
        )
    return f"{len(failures)} of {runs} runs failed and are left out ({named})."
