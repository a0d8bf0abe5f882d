"""What the README says to type works, and what it shows is there."""

import re
import shlex
from pathlib import Path

import pytest

from agents import curves, evaluate, search, show, transfer, tune
from agents.arguments import parse_arguments
from solar_env.support.readme import README

TEXT = README.read_text(encoding="utf-8")
COMMANDS = {module.__name__: module for module in (curves, evaluate, search, show, transfer, tune)}


def test_its_programs_run_one_after_the_other(capsys):
    programs = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
    assert len(programs) == 6
    namespace = {}
    for program in programs:
        exec(program, namespace)
    assert "'return'" in capsys.readouterr().out


def commands():
    """The lines that call a module of agents, as words without comments and without ``python -m``."""
    lines = [line for line in TEXT.splitlines() if line.startswith("python -m agents.")]
    called = [shlex.split(line, comments=True)[2:] for line in lines]
    return [words for words in called if words[0] in COMMANDS]


@pytest.mark.parametrize("words", commands(), ids=" ".join)
def test_its_commands_have_the_options_that_it_gives_them(words):
    name, *arguments = words
    if "--help" in arguments:
        with pytest.raises(SystemExit, match="0"):
            parse_arguments(COMMANDS[name].Args, arguments)
    else:
        parse_arguments(COMMANDS[name].Args, arguments)


def test_every_picture_and_file_that_it_links_to_is_there():
    links = re.findall(r"\]\((?!https?://)([^)#]+)\)", TEXT) + re.findall(r'(?:src|href)="([^"]+)"', TEXT)
    assert len(links) > 20
    missing = [link for link in links if not (Path(README).parent / link).exists()]
    assert not missing
