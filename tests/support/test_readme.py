"""Claims about the README pages: their programs run, their commands parse, their links lead somewhere."""

import re
import shlex

import pytest

from agents.comparison.evaluation import evaluate
from solar_env.__main__ import main
from solar_env.commands import table
from solar_env.commands.arguments import parse_arguments
from solar_env.environment.registration import DEPLOY
from solar_env.support.readme import PACKAGE, Section
from solar_env.verification.suite import CASES

ROOT = PACKAGE.parent
FRONT = ROOT / "README.md"
PAGES = [
    FRONT,
    ROOT / ".github" / "CONTRIBUTING.md",
    PACKAGE / "concepts.md",
    PACKAGE / "limits.md",
    *sorted([*PACKAGE.rglob("README.md"), *(ROOT / "agents").rglob("README.md")]),
]
TEXTS = {str(page.relative_to(ROOT)): page.read_text(encoding="utf-8") for page in PAGES}
CODE = [*PACKAGE.rglob("*.py"), *(ROOT / "agents").rglob("*.py")]
CONFIGS = [*(ROOT / "agents/configs").glob("*.json")]
CARDS = [*(ROOT / "agents/policies").glob("*/card.md")]
MOST_LINES = 120


def fenced(text, language):
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


WITH_PROGRAMS = [page for page, text in TEXTS.items() if fenced(text, "python")]


@pytest.mark.parametrize("page", WITH_PROGRAMS)
def test_the_programs_of_a_page_run_one_after_the_other(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    namespace = {}
    for program in fenced(TEXTS[page], "python"):
        exec(program.replace("learn(100_000)", "learn(100)").replace('"MlpPolicy", env', QUICK_PPO), namespace)


QUICK_PPO = '"MlpPolicy", env, n_steps=50, batch_size=50'


@pytest.mark.slow
def test_the_lines_with_which_ppo_learns_land_more_softly_than_the_tuned_damper(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    [program, *_] = fenced(TEXTS["agents/learning/README.md"], "python")
    exec(program.replace("100_000", "45_000"), {})
    (learned,), (damper,) = (
        evaluate([controller], 1, 0, DEPLOY, {"model": "rigid-clearance"}, progress=False)
        for controller in ("ppo_deploy.zip", "damper")
    )
    assert learned["return"] > damper["return"]


def commands():
    """Every command line of pages, cards and configurations, as words without `python`."""
    lines = set()
    for config in CONFIGS:
        lines |= set(re.findall(r'"command": "((?!solar-env search )[^"]*)"', config.read_text(encoding="utf-8")))
    for text in [*TEXTS.values(), *(card.read_text(encoding="utf-8") for card in CARDS)]:
        for block in fenced(text, ""):
            lines |= {line for line in block.splitlines() if re.match(r"python train\.py|solar-env ", line)}
        lines |= set(re.findall(r"`((?:python train\.py|solar-env )[^`\n]*)`", text))
    lines = {re.sub(r"^python train\.py", "solar-env train", line.partition(" > ")[0]) for line in lines}
    return sorted({shlex.join(shlex.split(line, comments=True)[1:]) for line in lines})


@pytest.mark.parametrize("command", commands())
def test_commands_have_the_options_that_the_pages_give_them(command):
    name, *arguments = shlex.split(command)
    if "--help" in (name, *arguments):
        assert main([name, *arguments]) == 0
    else:
        parse_arguments(table.load(table.COMMANDS, name).Args, arguments)


def test_commands_are_spelt_in_one_way():
    files = [*CODE, *CARDS, *CONFIGS]
    written = "\n".join([*TEXTS.values(), *(path.read_text(encoding="utf-8") for path in files)])
    assert re.findall(r"python -m (?:agents|solar_env [a-z]).*", written) == []


def test_verification_cases_that_the_pages_name_exist():
    results = (PACKAGE / "verification" / "results.csv").read_text(encoding="utf-8")
    named = {name for text in (*TEXTS.values(), results) for name in re.findall(r"verify --only ([\w-]+)", text)}
    assert len(named) > 15
    assert named <= set(CASES)


@pytest.mark.parametrize("page", TEXTS)
def test_every_picture_page_and_file_that_a_page_links_to_is_there(page):
    text = TEXTS[page]
    links = re.findall(r"\]\((?!https?://)([^)#]+)(?:#[^)]*)?\)", text) + re.findall(r'(?:src|href)="([^"]+)"', text)
    missing = [link for link in links if not (ROOT / page).parent.joinpath(link).exists()]
    assert not missing


def test_every_picture_of_the_pages_is_shown_or_linked():
    linked = {
        (ROOT / page).parent.joinpath(link).resolve()
        for page, text in TEXTS.items()
        for link in re.findall(r"\]\(([^)]+\.(?:png|gif))\)|src=\"([^\"]+)\"", text)
        for link in link
        if link
    }
    pictures = {path for page in PAGES for path in (page.parent / "figures").glob("*.png")}
    assert pictures - linked == set()


def test_the_front_page_is_short_and_leads_to_every_other_page():
    assert len(TEXTS["README.md"].splitlines()) <= MOST_LINES
    assert {page for page in TEXTS if f"]({page})" not in TEXTS["README.md"]} == {"README.md"}


def test_a_section_is_read_and_replaced_and_a_page_without_it_refused(tmp_path):
    section = Section(tmp_path / "README.md", "result", "solar-env study throughput --readme")
    lines = "<!-- result: written by `solar-env study throughput --readme` -->\n\nold\n\n<!-- end of result -->"
    section.page.write_text(f"# Title\n\n{lines}\n\nafter\n", encoding="utf-8")
    assert section.read() == "old"
    section.write("new")
    assert section.read() == "new"
    assert section.page.read_text(encoding="utf-8") == f"# Title\n\n{lines.replace('old', 'new')}\n\nafter\n"
    section.page.write_text("# Title\n", encoding="utf-8")
    with pytest.raises(ValueError, match="has no place for the result: add the lines"):
        section.write("newer")
