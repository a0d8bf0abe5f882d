"""Versions of the packages that results depend on, for the record."""

import platform
from importlib.metadata import PackageNotFoundError, version


def versions(*others: str) -> dict[str, str]:
    """Return the versions of Python, of this package, of the libraries that compute for it, and of `others`."""
    found = {"python": platform.python_version()}
    for name in ("solar-env", "numpy", "numba", "scipy", *others):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed as a package"
    return found
