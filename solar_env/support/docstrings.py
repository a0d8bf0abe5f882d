"""Docstrings read from source files, since `python -OO` removes docstrings, and importing may take seconds."""

import ast
import importlib.util
from pathlib import Path


def docstring(module: str, name: str) -> str:
    """Read the docstring of a class or function at the top of a module, without importing the module."""
    spec = importlib.util.find_spec(module)
    assert spec is not None
    assert spec.origin is not None
    (found,) = (
        node
        for node in ast.parse(Path(spec.origin).read_text(encoding="utf-8")).body
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and node.name == name
    )
    return ast.get_docstring(found) or ""
