"""The pages of the interface: `pip install -e ".[docs]" && pytest -m docs`."""

import ast
import re
import subprocess
import sys
import tokenize
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


FRAGMENT = re.compile(
    r"(?:Of|That|Those|What|Which|Whose|Whether|How|To|From|In|On|At|By|With|Without|Back|About|Any|Both|None|Once|As|For"
    r"|Where|When|While|Its?|They|So)\b|(?:\([^)]*\) )?\["
)
NOUN_PHRASE = re.compile(r"(?:The|A|An|All|Every|Each)\b|\(|`")
RIDDLE = re.compile(r"\b(?:so many|that of|what is|what are|lest|but for|in place of|in the place of|none)\b")
SOURCES = [path for package in ("solar_env", "agents") for path in (ROOT / package).rglob("*.py")]


def docstrings(path):
    """Every documented part of a module: its name, whether it is a function that one calls, and its docstring."""
    for part in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(part, (ast.Module, ast.ClassDef, ast.FunctionDef)) and (text := ast.get_docstring(part)):
            marks = [ast.unparse(mark) for mark in getattr(part, "decorator_list", [])]
            called = isinstance(part, ast.FunctionDef) and not any("property" in mark for mark in marks)
            yield f"{path.name}: {getattr(part, 'name', 'module')}", called, text


def test_docstrings_begin_with_a_noun_or_with_a_verb_and_its_object():
    """A fragment that leans on the name above it says nothing on a page; nor does a bare unit."""
    assert len(SOURCES) > 250
    read = [found for path in SOURCES for found in docstrings(path)]
    assert [f"{name}: {text}" for name, _, text in read if FRAGMENT.match(text)] == []
    assert [f"{name}: {text}" for name, called, text in read if called and NOUN_PHRASE.match(text)] == []


def test_docstrings_and_comments_repeat_the_noun_where_a_pronoun_would_be_a_riddle():
    said = [f"{name}: {text}" for path in SOURCES for name, _, text in docstrings(path)]
    for path in SOURCES:
        with path.open("rb") as file:
            comments = (token for token in tokenize.tokenize(file.readline) if token.type == tokenize.COMMENT)
            said += [f"{path.name}, line {token.start[0]}: {token.string}" for token in comments]
    assert len(said) > 3000
    assert [text for text in said if RIDDLE.search(text)] == []
