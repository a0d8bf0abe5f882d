"""Versions of the packages on which results depend, for the record in result files."""

import platform
from importlib.metadata import PackageNotFoundError, version


def versions(*others: str) -> dict[str, str]:
    """Return the versions of Python, of this package, of its numerical libraries, and of `others`, by name."""
    found = {"python": platform.python_version()}
    for name in ("solar-env", "numpy", "numba", "scipy", *others):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed as a package"
    return found
