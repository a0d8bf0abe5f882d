"""The pages of the interface: `pip install -e ".[docs]" && pytest -m docs`."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import solar_env

ROOT = Path(solar_env.__file__).parent.parent
MARKDOWN = ("commands", "pictures", "studies", "support", "verification")


@pytest.mark.docs
def test_the_pages_of_both_packages_build_without_warnings(tmp_path):
    pytest.importorskip("pdoc")
    from matplotlib import font_manager  # noqa: F401 (asks a program for the fonts, once; pdoc would not let it)

    command = [sys.executable, "-m", "pdoc", "--output-directory", str(tmp_path), "solar_env", "agents"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert re.findall("^Warn.*", done.stderr, re.MULTILINE) == []
    for package in ("solar_env", "agents"):
        modules = {
            ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
            for path in (ROOT / package).rglob("*.py")
            if not path.stem.startswith("_") or path.stem == "__init__"
        }
        pages = {".".join(page.relative_to(tmp_path).with_suffix("").parts) for page in tmp_path.rglob("*.html")}
        assert modules <= pages
    front = (tmp_path / "solar_env.html").read_text(encoding="utf-8")
    assert "Normal contact law" in front, "the package's page holds the recipes for contributors"


def docstrings(node, public=True):
    """Names and docstrings of the public classes and functions in a part of a module."""
    for part in ast.iter_child_nodes(node):
        if isinstance(part, (ast.ClassDef, ast.FunctionDef)):
            own = public and not part.name.startswith("_")
            if own:
                yield part.name, ast.get_docstring(part) or ""
            yield from docstrings(part, own)


def test_docstrings_begin_with_the_thing_or_with_what_it_does():
    """A fragment that leans on the name above it says nothing on a page; nor does a bare unit."""
    fragment = re.compile(r"(?:Of|That|Those|What|To|From|In|Back|About|Any|Both)\b|(?:\([^)]*\) )?\[")
    files = [path for package in ("solar_env", "agents") for path in (ROOT / package).rglob("*.py")]
    assert len(files) > 250
    read = [(path, *found) for path in files for found in docstrings(ast.parse(path.read_text(encoding="utf-8")))]
    assert [f"{path.name}: {name}: {text}" for path, name, text in read if fragment.match(text)] == []


def test_docstrings_have_no_sphinx_roles():
    """Markdown shows them as they are typed."""
    role = re.compile(r":(?:func|class|mod|meth|attr):`")
    files = [path for room in MARKDOWN for path in (ROOT / "solar_env" / room).rglob("*.py")]
    assert [str(path.relative_to(ROOT)) for path in files if role.search(path.read_text(encoding="utf-8"))] == []


def test_the_tests_that_run_without_the_compiler_exist():
    short = (ROOT / "tests" / "short.txt").read_text().splitlines()
    named = [line.removeprefix("--deselect=").partition("::") for line in short if line]
    assert [path for path in {path for path, *_ in named} if not (ROOT / path).exists()] == []
    functions = [(path, test.partition("[")[0]) for path, _, test in named if test]
    assert [each for each in functions if f"def {each[1]}(" not in (ROOT / each[0]).read_text()] == []
