"""Versions of what results depend on, for the record."""

import platform
from importlib.metadata import PackageNotFoundError, version


def versions(*others: str) -> dict[str, str]:
    """Versions of this package, of what computes for it, of `others`, and of Python."""
    found = {"python": platform.python_version()}
    for name in ("solar-env", "numpy", "numba", "scipy", *others):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed as a package"
    return found
