"""The paper's figures and claims: what it reports of rigid panels, and the algorithms that read it off."""

import math
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from solar_env.__main__ import main
from solar_env.array import ArrayParameters
from solar_env.commands.studies import paper
from solar_env.mechanics.running.trajectory import Trajectory, contact_record
from solar_env.studies.common.tables import read_table, write_table
from solar_env.studies.paper import cases, kinds, measures, survey
from solar_env.studies.paper.claims import CLAIMS
from solar_env.studies.paper.figures import FIGURES
from solar_env.verification.arrays import theory

TIME = np.linspace(0.0, 30.0, 3001)
MEASURED = {row["key"]: row for row in read_table(paper.FOLDER / "claims.csv").rows}
# One member of each case, simulated once.


@cache
def simulate_once(case: str) -> Trajectory:
    return cases.simulate_run(cases.CaseRun(case))


@pytest.fixture(scope="module")
def rigid() -> dict[str, Trajectory]:
    """The paper's rigid deployment with clearance."""
    return {"rigid-clearance": simulate_once("rigid-clearance")}


def made(contacts: list[tuple[int, float, float, float]], **arrays: Any) -> Any:
    """A trajectory of one quantity or another; contacts are (joint, start, end, peak force)."""
    table = np.array([(j, start, end, 0.1, peak, 0.0, 0.0) for j, start, end, peak in contacts], dtype=contact_record)
    return SimpleNamespace(**{"time": TIME, "contacts": table, "latch_times": np.array([13.0, 13.1]), **arrays})


def claim(key: str) -> Any:
    return next(claim for claim in CLAIMS if claim.key == key)


CABLE = claim("cable-torque")


@pytest.mark.parametrize("key", [c.key for c in CLAIMS if c.cases == ("rigid-clearance",)])
def test_rigid_panels_do_what_the_paper_says_or_differ_as_the_table_of_claims_has_it(
    rigid: dict[str, Trajectory], key: str
) -> None:
    assert claim(key).holds(claim(key).value(rigid)) == (MEASURED[key]["agrees"] == "yes")


@pytest.mark.slow
@pytest.mark.parametrize("key", [c.key for c in CLAIMS if c.cases != ("rigid-clearance",)])
def test_what_the_other_cases_do_is_what_the_table_of_claims_says(key: str) -> None:
    """Of one member of the ensemble, up to the width of the interval that the members span."""
    row, own = MEASURED[key], claim(key)
    width = row["greatest"] - row["least"]
    value = own.value({case: simulate_once(case) for case in own.cases})
    assert row["least"] - width <= value <= row["greatest"] + width


def test_the_initial_phase_ends_with_the_first_contact_that_lasts() -> None:
    motion = made([(1, 0.5, 13.2, 1.0), (0, 0.1, 0.101, 9.0), (0, 0.9, 13.1, 1.0), (0, 14.0, math.nan, 3.0)])
    assert [measures.settled(motion, joint) for joint in (0, 1)] == [0.9, 0.5]
    assert [int((measures.phase_of(motion, 0) == k).sum()) for k in (1, 2, 3)] == [90, 1210, 1701]
    assert math.isnan(measures.settled(made([(0, 0.1, 0.101, 9.0)]), 0))


def test_forces_by_window_hold_the_peaks_that_samples_miss() -> None:
    force = np.zeros((len(TIME), 2))
    force[TIME < 1.0, 0] = 2.0
    motion = made([(0, 1.5, 1.501, 70.0), (0, 0.0, 1.0, 5.0), (1, 0.5, 0.501, 9.0)], normal_force=force)
    assert measures.greatest_force(motion, 0, np.array([0.0, 1.0, 2.0, 3.0])).tolist() == [2.0, 70.0, 0.0]


def test_a_delayed_oscillation_lags() -> None:
    latched = np.array([10.0, 10.0])
    # Neither latchings nor lags are multiples of a sample.
    motions = [
        made([], angles=np.stack([np.sin(3.0 * (TIME - late))] * 2, axis=1), latch_times=latched + start)
        for late, start in ((0.0, 0.0), (0.2033, 0.0041))
    ]
    assert measures.lag(*motions, joint=0) == pytest.approx(0.2033 - 0.0041, abs=2e-3)
    assert measures.lag(*reversed(motions), joint=1) == pytest.approx(-0.2033 + 0.0041, abs=2e-3)


def test_a_slide_counts_through_the_cut_of_the_angle_and_has_a_sign() -> None:
    angle = 3.0 + np.clip(20.0 * (TIME - 13.0), 0.0, 1.5)
    path = 2e-4 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    motion = made([], eccentricity=np.stack([path, path[:, ::-1]], axis=1), latch_times=np.array([13.0, 13.0]))
    assert measures.slide(motion, 0) == pytest.approx(-math.degrees(1.5))
    assert measures.slide(motion, 1) == pytest.approx(math.degrees(1.5))


def test_vibration_is_what_a_running_mean_leaves() -> None:
    rates = 0.1 * TIME + 0.02 * np.sin(2.0 * math.pi * 4.0 * TIME)
    motion = made([], rates=np.stack([rates, rates], axis=1))
    assert measures.vibration(motion) == pytest.approx(0.02 / math.sqrt(2.0), rel=0.01)


def test_every_figure_of_the_paper_is_there() -> None:
    assert list(FIGURES) == list(range(5, 24))
    assert {case for figure in FIGURES.values() for case in figure.cases} == set(cases.CASES)


def test_a_figure_is_drawn_from_its_table_alone_with_what_the_table_shows_in_its_title(
    rigid: dict[str, Trajectory], tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    figure = FIGURES[10]
    write_table(tmp_path / "table.csv", figure.table([rigid]), {"command": "paper"})
    for name in ("one.png", "two.png"):
        figure.draw(read_table(tmp_path / "table.csv"), tmp_path / name)
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "two.png").read_bytes()
    drawn: list[Any] = []
    monkeypatch.setattr(kinds, "save_figure", lambda picture, *_, **__: drawn.append(picture))
    figure.draw(read_table(tmp_path / "table.csv"), tmp_path / "three.png")
    first, second = rigid["rigid-clearance"].peak_force
    words = f"Fig. 10: contact forces, rigid-clearance; nominal run:\nat most {first:.3g} N at joint 1, {second:.3g} N"
    assert drawn[0].get_suptitle().startswith(words)


def test_a_figure_of_an_ensemble_has_medians_and_their_range() -> None:
    members = [
        {"rigid-ideal": made([], angles=np.outer(np.ones(len(TIME)), [rate, 2.0 * rate]))} for rate in (1.0, 4.0, 2.0)
    ]
    row = FIGURES[6].table(members)[-1]
    assert [row[f"angle_2_rad{end}"] for end in ("", "_least", "_greatest")] == [4.0, 2.0, 8.0]
    assert list(FIGURES[6].members) == list(range(cases.MEMBERS))
    assert "median and range of 6 runs" in FIGURES[6].heading
    assert "nominal run" in FIGURES[10].heading


def test_the_command_writes_table_and_picture_of_one_figure(tmp_path: Any) -> None:
    assert main(["study", "paper", "--only", "6", "--jobs", "1", "--out", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"figure-06.csv", "figure-06.png"}
    table = read_table(tmp_path / "figure-06.csv")
    assert table.column("angle_2_rad")[-1] == pytest.approx(math.pi, abs=0.03)
    assert table.provenance["figure"] == "6"


@pytest.mark.parametrize(("option", "named"), [(["--only", "4"], "paper '4'"), (["--jobs", "0"], "jobs = 0")])
def test_wrong_input_is_refused(option: list[str], named: str, capsys: Any, tmp_path: Any) -> None:
    assert main(["study", "paper", *option, "--out", str(tmp_path)]) == 2
    assert named in capsys.readouterr().err


def test_with_the_tangential_force_the_couple_latches_a_second_before_the_paper() -> None:
    """Rigid panels on ideal hinges: torques on main body and panels by a unit of the cable's."""
    p = ArrayParameters.preset("paper")
    chain, start, matrix = theory.make_chain(p), theory.folded_angles(p), theory.hinge_map(p)
    latch_times = []
    for shares in ((1.0, 0.0, -1.0), (1.0, -1.0, -1.0)):

        def torques(angles: Any, _: Any, shares: tuple[float, ...] = shares) -> Any:
            joints = matrix @ (angles - start)
            cable = p.by_joint("cable_stiffness", 0) * (2.0 * joints[0] - joints[1])
            return matrix.T @ theory.spring_torques(p, joints) + cable * np.array(shares)

        times = np.arange(11.5, 14.0, 0.02)
        angles = chain.solve(list(start), torques, list(times)).y[:3].T - start
        latch_times.append(float(np.interp(math.pi / 2, (angles @ matrix.T)[:, 0], times)))
    assert latch_times == pytest.approx([13.2, 12.15], abs=0.05)


def judged(values: list[float], at: dict[float, float], monkeypatch: pytest.MonkeyPatch) -> survey.Finding:
    """A finding whose figure is 1 to agree; `at`: figures by value of the cable's stiffness."""
    monkeypatch.setattr(survey, "RANGES", {"cable_stiffness": tuple(at)})
    own = replace(
        claim("cable-torque"), cases=("rigid-ideal",), measure=float, low=1.0, high=1.0,
        open_parameters=("cable_stiffness",),
    )  # fmt: skip
    motions: dict[Any, Any] = {cases.CaseRun("rigid-ideal", k): value for k, value in enumerate(values)}
    for value, figure in at.items():
        for member in range(survey.RANGE_MEMBERS):
            motions[cases.CaseRun("rigid-ideal", member, (("cable_stiffness", value),))] = figure
    return survey.judge(own, motions)


def test_a_claim_is_judged_by_the_median_of_the_members(monkeypatch: pytest.MonkeyPatch) -> None:
    finding = judged([1.0, 1.0, 0.5], {}, monkeypatch)
    assert (finding.agrees, finding.median, finding.least) == (True, 1.0, 0.5)
    assert finding.agreeing == pytest.approx(2.0 / 3.0)
    text = survey.as_markdown([finding, judged([1.0, 0.5, 0.5], {}, monkeypatch)])
    assert text.splitlines()[2:] == [f"| `cable-torque` | {CABLE.statement} | above 1 | 0.5 | {CABLE.why} |"]


def test_claims_that_differ_for_one_reason_share_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    one = judged([0.5], {}, monkeypatch)
    pair = [replace(one, claim=claim(f"{key}-2")) for key in ("swing", "stronger")]
    [line] = survey.as_markdown(pair).splitlines()[2:]
    assert line.startswith(f"| `swing-2`, `stronger-2` | {pair[0].claim.statement}; strength of the impacts (mean")
    assert f"| above 1 | 0.5; 0.5 | {pair[0].claim.why} |" in line


def test_where_in_the_range_of_an_open_parameter_a_claim_holds_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    finding = judged([0.5], {5.0: 1.0, 80.0: 0.5}, monkeypatch)
    assert finding.holds_for == {"cable_stiffness": [5.0]}
    assert finding.fails_for == {"cable_stiffness": [20.0, 80.0]}, "the default included"
    assert survey.as_rows([finding])[0]["holds_at"] == "cable_stiffness 5, not 20, 80"


def test_the_claims_need_no_run_that_is_not_planned() -> None:
    runs = survey.planned_runs(members=2)
    assert len(runs) == len(set(runs))
    assert {run.case for run in runs} == {case for claim in CLAIMS for case in claim.cases}
    assert {parameter for run in runs for parameter, _ in run.changes} == survey.RANGES.keys()


def test_the_readme_holds_the_claims_as_measured(tmp_path: Any) -> None:
    figures = ("median", "least", "greatest", "agreeing")
    findings = [
        survey.Finding(own, **{name: row[name] for name in figures}, holds_for={}, fails_for={})
        for own, row in zip(CLAIMS, MEASURED.values(), strict=True)
    ]
    rows = [{**row, "holds_at": MEASURED[row["key"]]["holds_at"]} for row in survey.as_rows(findings)]
    write_table(tmp_path / "claims.csv", rows, {})
    assert list(read_table(tmp_path / "claims.csv").rows) == list(MEASURED.values())
    assert all(one.agrees or one.claim.why for one in findings)
    assert paper.SECTION.read() == survey.as_markdown(findings)
    agreeing = sum(one.agrees for one in findings)
    assert f"{agreeing} of {len(findings)} claims of the paper" in paper.SECTION.page.read_text(encoding="utf-8")


def test_wear_and_impacts_are_compared_joint_by_joint() -> None:
    # Joint 1 has 0.1 mm in the first distribution and 0.2 mm in the second, joint 2 the other way round.
    late = [(0, 14.0, 14.001, 10.0), (1, 14.0, 14.001, 60.0), (1, 15.0, 15.001, 60.0)]
    early = [(0, 14.0, 14.001, 30.0), (0, 15.0, 15.001, 30.0), (1, 14.0, 14.001, 20.0), (0, 1.0, 2.0, 9.0)]
    lasting = [(0, 0.5, 13.0, 1.0), (1, 0.5, 13.0, 1.0)]
    member = {
        "distribution-1": made([*lasting, *late], wear_depth=np.array([1.0, 4.0])),
        "distribution-2": made([*lasting, *early], wear_depth=np.array([3.0, 2.0])),
    }
    assert claim("distribution-size-1").value(member) == pytest.approx(30.0 / 10.0)
    assert claim("distribution-size-2").value(member) == pytest.approx(60.0 / 20.0)
    assert claim("distribution-density").value(member) == pytest.approx(min(1 / 2, 1 / 2))
    assert claim("distribution-wear").value(member) == pytest.approx(3.0 / 4.0)
    assert claim("distribution-evenness").value(member) == pytest.approx((3.0 / 2.0) / (4.0 / 1.0))


# Kind of figure and number of cases -> number of axes, end of the label of one of them, end of the paper's axis.
LOOKS: dict[tuple[str, int], tuple[int, str, float | None]] = {
    ("Angles", 1): (1, "[rad]", None), ("JournalPath", 1): (5, "y [µm]", None),
    ("ContactForces", 1): (2, "force [N]", None), ("ContactForces", 2): (4, "force [N]", 300.0),
    ("Torques", 1): (2, "[N m]", None), ("Models", 4): (8, "difference from rigid-ideal", None),
    ("Wear", 2): (2, "depth [m]", 7e-14),
}  # fmt: skip
PLACES = {"time_s", "phase", "clearance_um", "angle_deg"}


def scribbled(seed: int) -> Any:
    """A trajectory of which no two quantities are alike."""
    rng = np.random.default_rng(seed)
    names = ("angles", "rates", "normal_force", "latch_torque", "cable_torque")
    arrays = {name: rng.random((len(TIME), 2)) for name in names}
    wear = {f"wear_{surface}": 1e-14 * rng.random((2, 8)) for surface in ("bearing", "journal")}
    path = 1e-4 * rng.random((len(TIME), 2, 2))
    lasting = [(0, 0.9, 13.1, 1.0), (1, 0.9, 13.1, 1.0)]
    return made(lasting, **arrays, **wear, eccentricity=path, clearance=np.array([2e-4, 1e-4]))


@pytest.mark.parametrize("number", [number for number, figure in FIGURES.items() if figure.cases])
def test_the_curves_of_a_figure_are_the_columns_of_its_table(
    number: int, tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Any] = []
    monkeypatch.setattr(kinds, "save_figure", lambda picture, *_, **__: drawn.append(picture))
    figure = FIGURES[number]
    member = {case: scribbled(seed) for seed, case in enumerate(cases.CASES)}
    write_table(tmp_path / "table.csv", figure.table([member] * len(figure.members)), {"command": "paper"})
    table = read_table(tmp_path / "table.csv")
    figure.draw(table, tmp_path / "picture.png")
    axes, (count, label, top) = drawn[0].axes, LOOKS[type(figure).__name__, len(figure.cases)]
    assert len(axes) == count
    assert any(axis.get_ylabel().endswith(label) for axis in axes)
    assert drawn[0].get_suptitle().startswith(figure.heading)
    lines = [line for axis in axes for line in axis.lines]
    for name in table.rows[0].keys() - PLACES:
        if not name.endswith(("_least", "_greatest")):
            assert sum(np.array_equal(line.get_ydata(), table.column(name)) for line in lines) == 1, name
    ends = [line.get_ydata()[0] for line in lines if line.get_label() == "end of the paper's axis"]
    assert ends == ([] if top is None else [top] * count)
