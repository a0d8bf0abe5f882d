"""Claims on flexible panels over mesh and damping: what a claim is owed to, and the table on the page."""

import pytest

from solar_env.commands.studies.paper import LEVELS_SECTION
from solar_env.studies.paper import levels
from solar_env.studies.paper.levels import CONVERGED, DAMPED, FINER, FLEXIBLE_CLAIMS, LEVELS, PAPER, verdict


@pytest.mark.parametrize(
    ("holding", "owed"),
    [
        (LEVELS, "physics"),
        (CONVERGED, "physics, but not on the paper's mesh"),
        ((PAPER, CONVERGED[0]), "physics, if the damping is 1e-06 s"),
        ((PAPER, FINER, DAMPED), "the mesh's"),
        ((PAPER, FINER), "missing damping's"),
        ((PAPER,), "the mesh's, undamped"),
        ((), "holds nowhere"),
    ],
)
def test_a_claim_is_owed_to_what_it_needs(holding, owed):
    assert verdict({level: level in holding for level in LEVELS}) == owed


def test_the_table_has_medians_over_the_members_and_bold_where_claims_hold():
    claim = FLEXIBLE_CLAIMS[0]
    results = []
    for cell in levels.cells():
        figure = claim.low * (1.001 if cell["level"] == PAPER.name else 0.9) + 1e-9 * cell["member"]
        results.append(dict.fromkeys((one.key for one in FLEXIBLE_CLAIMS), figure))
    assert len(results) == levels.MEMBERS * len(LEVELS)
    row = levels.as_markdown(results).splitlines()[2]
    assert row.count("**") == 2
    assert row.endswith("| the mesh's, undamped |")


def test_the_page_has_all_levels_and_claims_with_the_verdicts_that_its_figures_call_for():
    header, _, *rows = (line.strip("|").split(" | ") for line in LEVELS_SECTION.read().splitlines())
    assert [name.strip() for name in header[1:-1]] == [level.name for level in LEVELS]
    assert len(rows) == len(FLEXIBLE_CLAIMS)
    for claim, (statement, *figures, found) in zip(FLEXIBLE_CLAIMS, rows, strict=True):
        assert statement.strip().startswith(claim.statement)
        assert found.strip() == verdict({level: "**" in figure for level, figure in zip(LEVELS, figures, strict=True)})
