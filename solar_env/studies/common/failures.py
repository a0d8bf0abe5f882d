"""Failed simulations of an ensemble, which are left out, named and counted, up to a tenth of the runs."""

from collections.abc import Mapping

LARGEST_SHARE = 0.1


def told(failures: Mapping[str, str], runs: int) -> str:
    """State in one sentence which of `runs` runs failed and why, by name; return an empty text if every run succeeded.

    Raises:
        ValueError: if more than a tenth of the runs failed: the remaining runs would be a biased sample.
    """
    if not failures:
        return ""
    named = "; ".join(f"{name}: {reason}" for name, reason in failures.items())
    if len(failures) > LARGEST_SHARE * runs:
        raise ValueError(
            f"{len(failures)} of {runs} runs failed, more than the {LARGEST_SHARE:.0%} that may be left out ({named})"
        )
    return f"{len(failures)} of {runs} runs failed and are left out ({named})."
