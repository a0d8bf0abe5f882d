"""Sets of what the paper leaves open: what the tables of the search hold, and what the page says of them."""

import numpy as np
import pytest

from solar_env.__main__ import main
from solar_env.array import ArrayParameters
from solar_env.commands.studies.paper import FOLDER
from solar_env.studies.common.tables import read_table
from solar_env.studies.paper import measures, sets
from solar_env.studies.paper.cases import CASES, CaseRun, simulate_run
from solar_env.studies.paper.claims import CLAIMS

RIGID_CLAIMS = {claim.key: claim for claim in CLAIMS if not claim.on_flexible_panels}
PAGE = (FOLDER / "README.md").read_text(encoding="utf-8")


def motions_of(changes, cases):
    return {case: simulate_run(CaseRun(case, changes=changes)) for case in cases}


def test_the_preset_is_a_set_and_other_sets_are_what_their_tables_say():
    preset, found = ArrayParameters.preset("paper"), sets.found_sets()
    assert preset.with_changes(dict(found["preset"])) == preset
    loop = preset.with_changes(dict(found["stiff loop"]))
    assert (loop.hinge_y, loop.cable_torque_ratio, loop.friction_sliding) == (0.5, 1.28, "material")
    assert (loop.stop(0).stiffness, loop.by_joint("friction_speed_full", 0)) == (1.6e4, 0.013)
    readings = {preset.with_changes(dict(found[f"front {k}"])).contact_stiffness for k in range(1, 155)}
    assert readings == {None, preset.contact_stiffness}
    assert "front 155" not in found


def test_a_set_that_is_none_is_refused_by_its_name(capsys):
    assert main(["study", "paper", "--only", "front 155"]) == 2
    assert "part of the study paper 'front 155' is unknown" in capsys.readouterr().err


def test_the_page_names_the_pairs_that_its_table_has_apart_and_no_set_of_the_front_meets_both():
    pairs, front = (read_table(FOLDER / f"identification-{name}.csv") for name in ("pairs", "front"))
    assert list(pairs.values("claim")) == list(RIGID_CLAIMS)
    alone = {row["claim"]: row["sets"] for row in pairs.rows if row["claim"] == row["other"]}
    apart = [(row["claim"], row["other"]) for row in pairs.rows if not row["sets"]]
    apart = [(a, b) for a, b in apart if alone[a] and alone[b]]
    assert apart
    for pair in apart:
        assert " and ".join(f"`{key}`" for key in pair) in PAGE
        both = (row for row in front.rows if "" not in [row[key] for key in pair])
        assert not any(all(RIGID_CLAIMS[key].holds(row[key]) for key in pair) for row in both)


def test_the_table_of_sets_on_the_page_counts_what_the_table_of_figures_holds():
    for row in read_table(FOLDER / "identification-shortlist.csv").rows:
        met = sum(claim.holds(row[claim.key]) for claim in CLAIMS)
        assert met == row["claims_met"]
        assert f"| {row['name']} | {met} of {len(CLAIMS)} |" in PAGE


def test_the_stiff_loop_does_at_joint_2_what_the_preset_does_not():
    for name, expected in (("stiff loop", True), ("preset", False)):
        motions = motions_of(sets.found_sets()[name], ["rigid-clearance"])
        for key in ("lock-torque-2", "settling-2", "swing-2"):
            assert RIGID_CLAIMS[key].holds(RIGID_CLAIMS[key].value(motions)) == expected


def test_wear_is_proportional_to_its_coefficient_on_which_nothing_else_hangs():
    cases = [case for case in CASES if case.startswith(("rigid", "distribution")) and not case.endswith("eq-40")]
    one, four = (motions_of((("wear_coefficient", coefficient),), cases) for coefficient in (1e-15, 4e-15))
    for key, claim in RIGID_CLAIMS.items():
        factor = 4.0 if key == "wear-depth" else 1.0
        assert claim.value(four) == pytest.approx(factor * claim.value(one), rel=1e-4)


def greatest_forces(changes):
    """Greatest contact forces [N] from the latching on, from 14.5 s on and from 27.5 s on, by case."""
    forces = {}
    for case, motion in motions_of(changes, ["rigid-clearance", "distribution-1", "distribution-2"]).items():
        edges = np.array([motion.latch_times.max() - 0.05, 14.5, 27.5, motion.time[-1]])
        windows = np.max([measures.greatest_force(motion, joint, edges) for joint in (0, 1)], axis=0)
        forces[case] = np.maximum.accumulate(windows[::-1])[::-1]
    return forces


@pytest.mark.parametrize("name", ["preset", "mid-side", "stiff loop"])
def test_figures_20_and_21_from_14_5_s_on_do_not_reconcile_the_forces_of_a_set_of_the_page(name):
    forces = greatest_forces(sets.found_sets()[name])
    assert forces["rigid-clearance"][0] > 500.0
    assert max(forces["distribution-1"][1], forces["distribution-2"][1]) > 500.0


@pytest.mark.slow
def test_of_the_front_one_set_has_the_papers_forces_and_its_bursts_fade():
    found = sets.found_sets()
    every = (greatest_forces(found[f"front {number}"]) for number in range(1, 155))
    hard = [forces for forces in every if 700.0 <= forces["rigid-clearance"][0] <= 900.0]
    assert 4 <= len(hard) <= 9
    for first in (0, 1):
        kept = [own for own in hard if max(own["distribution-1"][first], own["distribution-2"][first]) <= 320.0]
        assert len(kept) == 1
    forces = kept[0]["rigid-clearance"]
    assert forces[2] < 0.05 * forces[0]


def test_the_command_judges_a_set_and_says_no_reasons_of_the_preset(tmp_path, monkeypatch, capsys):
    motions = motions_of((), ["rigid-clearance"])
    monkeypatch.setattr("solar_env.studies.paper.claims.CLAIMS", [RIGID_CLAIMS["lead"], RIGID_CLAIMS["turning"]])
    monkeypatch.setattr("solar_env.studies.paper.cases.simulate_run", lambda run: motions[run.case])
    assert main(["study", "paper", "--only", "mid-side", "--jobs", "1", "--quiet", "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "1 of 2 claims agree" in said
    assert "cable loop" not in said
    assert len(read_table(tmp_path / "claims-mid-side.csv").rows) == 2
