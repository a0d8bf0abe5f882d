import re
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from solar_env.pictures.plots import DISSIPATED, PUT_IN, STORED, plot_comparison, plot_deployment

CONTACT = np.dtype([("joint", np.int64), ("start_s", np.float64), ("peak_force", np.float64)])
ENERGIES = (*STORED, *PUT_IN, *DISSIPATED, "residual")


def make_trajectory(joints=2, clearance=2e-4, samples=200, bins=36):
    """Plausible curves under the names that plots read."""
    time = np.linspace(0.0, 30.0, samples)
    ramp = np.outer(time / 30.0, np.ones(joints))
    direction = np.stack([np.cos(7.0 * ramp), np.sin(7.0 * ramp)], axis=-1)
    contacts = np.array([(joints - 1, 2.0, 40.0), (0, 13.1, 700.0)], dtype=CONTACT)
    return SimpleNamespace(
        time=time,
        angles=np.pi / 2 * ramp,
        eccentricity=clearance * direction,
        normal_force=0.1 + ramp,
        latch_torque=ramp,
        cable_torque=-ramp,
        energies={name: np.sin(time + k) for k, name in enumerate(ENERGIES)},
        wear_bearing=np.full((joints, bins), 1e-14 if clearance else 0.0),
        wear_journal=np.zeros((joints, bins)),
        contacts=contacts if clearance else contacts[:0],
        latch_times=np.where(np.arange(joints) == 0, 13.1, np.nan),
        clearance=np.full(joints, clearance),
        postlock_peak_force=np.full(joints, 700.0),
        metadata={"model": "rigid-clearance"},
    )


def deflections(trajectory, size=0.01):
    return size * np.sin(trajectory.time[:, None] + np.arange(len(trajectory.clearance)))


@pytest.mark.parametrize(("suffix", "start"), [(".png", b"\x89PNG"), (".pdf", b"%PDF"), (".svg", b"<?xml")])
def test_each_suffix_gives_a_file_of_its_format_and_twice_the_same(tmp_path, suffix, start):
    first, second = tmp_path / f"first{suffix}", tmp_path / f"second{suffix}"
    plot_deployment(make_trajectory(joints=1), first)
    plot_deployment(make_trajectory(joints=1), str(second))
    assert first.read_bytes().startswith(start)
    assert first.read_bytes() == second.read_bytes()


@pytest.mark.parametrize("name", ["figure", "figure.gif"])
def test_other_suffixes_are_refused_before_anything_is_written(tmp_path, name):
    with pytest.raises(ValueError, match=r"\.pdf, \.png, \.svg"):
        plot_deployment(make_trajectory(), tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def polar_axes(figure):
    return [axis for axis in figure.findobj() if getattr(axis, "name", None) == "polar"]


@pytest.mark.parametrize("joints", [1, 3])
def test_every_joint_with_clearance_has_its_force_path_and_wear(tmp_path, saved_figures, joints):
    plot_deployment(make_trajectory(joints), tmp_path / "figure.png")
    labels = [axis.get_ylabel() for axis in saved_figures[0].axes]
    assert sum(label.startswith("contact force") for label in labels) == joints
    assert len(polar_axes(saved_figures[0])) == joints


def test_ideal_joints_have_neither_path_nor_wear(tmp_path, saved_figures):
    plot_deployment(make_trajectory(clearance=0.0), tmp_path / "figure.png")
    labels = [axis.get_ylabel() for axis in saved_figures[0].axes]
    assert sum(label.startswith("joint force") for label in labels) == 2
    assert polar_axes(saved_figures[0]) == []


def test_peaks_between_samples_are_inside_the_axes_and_every_axis_names_its_unit(tmp_path, saved_figures):
    trajectory = make_trajectory()
    plot_deployment(trajectory, tmp_path / "figure.png")
    axes = saved_figures[0].axes
    tops = [axis.get_ylim()[1] for axis in axes if axis.get_ylabel().startswith("contact force")]
    assert trajectory.normal_force.max() < 40.0
    assert np.all(np.array(tops) > [700.0, 40.0])
    labels = [axis.get_ylabel() + axis.get_title() + axis.get_xlabel() for axis in axes]
    assert [label for label in labels if "[" not in label] == []


def test_no_contact_no_wear_and_no_latch_are_drawn(tmp_path):
    trajectory = make_trajectory(joints=1)
    trajectory.contacts = trajectory.contacts[:0]
    trajectory.normal_force[:] = 0.0
    trajectory.wear_bearing[:] = 0.0
    trajectory.latch_times[:] = np.nan
    plot_deployment(trajectory, tmp_path / "figure.png")
    assert (tmp_path / "figure.png").exists()


def curves(figure, label):
    """The curves of the axes with this label."""
    (axis,) = [axis for axis in figure.axes if axis.get_ylabel() == label]
    return {line.get_label(): line.get_ydata() for line in axis.lines}


@pytest.fixture(scope="module")
def distinct(tmp_path_factory):
    """A trajectory in which no two curves are alike and no two surfaces wear alike, and its figure."""
    trajectory = make_trajectory()
    shares = np.array([1.0, 0.7])
    trajectory.angles = trajectory.angles * shares
    trajectory.latch_torque, trajectory.cable_torque = 3.0 * np.sin(trajectory.angles), -0.2 * trajectory.angles**2
    trajectory.latch_times = np.array([13.1, 12.4])
    trajectory.normal_force = trajectory.normal_force * [1.0, 3.0]
    trajectory.clearance = np.array([2e-4, 3e-4])
    trajectory.eccentricity = trajectory.eccentricity * shares[:, None] + [0.0, 2e-5]
    trajectory.wear_bearing = 1e-14 * np.outer(shares, 1.0 + np.arange(36))
    trajectory.wear_journal = 5e-15 * np.outer(shares[::-1], 40.0 - np.arange(36))
    figures = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("matplotlib.figure.Figure.savefig", lambda figure, *how, **more: figures.append(figure))
        plot_deployment(trajectory, tmp_path_factory.mktemp("drawn") / "figure.png")
    return trajectory, figures[0]


def axes_called(figure, start):
    """The axes whose label or title begins so."""
    return [axis for axis in figure.axes if axis.get_ylabel().startswith(start) or axis.get_title().startswith(start)]


@pytest.mark.parametrize(
    ("label", "values"),
    [
        ("angle [deg]", lambda trajectory: np.degrees(trajectory.angles)),
        ("latch torque\n[N m]", lambda trajectory: trajectory.latch_torque),
        ("cable torque\n[N m]", lambda trajectory: trajectory.cable_torque),
    ],
)
def test_angles_are_drawn_in_degrees_and_each_torque_under_its_own_name(distinct, label, values):
    trajectory, figure = distinct
    (axis,) = axes_called(figure, label)
    for line, expected in zip(axis.lines[:2], values(trajectory).T, strict=True):
        assert np.array_equal(line.get_xdata(), trajectory.time)
        assert np.array_equal(line.get_ydata(), expected)


def test_the_latch_times_are_dotted_among_the_angles(distinct):
    (axis,) = axes_called(distinct[1], "angle [deg]")
    angles, locks = axis.lines[:2], axis.lines[2:]
    assert [set(lock.get_xdata()) for lock in locks] == [{13.1}, {12.4}]
    assert [lock.get_color() for lock in locks] == [angle.get_color() for angle in angles]


def test_the_force_of_each_joint_is_drawn_with_the_peaks_of_its_own_contacts(distinct):
    trajectory, figure = distinct
    forces = axes_called(figure, "contact force")
    for joint, (axis, start, peak) in enumerate(zip(forces, (13.1, 2.0), (700.0, 40.0), strict=True)):
        assert axis.get_ylabel() == f"contact force\njoint {joint + 1} [N]"
        assert np.array_equal(axis.lines[0].get_ydata(), trajectory.normal_force[:, joint])
        (stem,) = axis.collections[0].get_segments()
        assert stem[-1].tolist() == [start, peak]


@pytest.mark.parametrize("joint", [0, 1])
def test_the_path_of_each_journal_is_drawn_in_micrometres_within_its_clearance(distinct, joint):
    trajectory, figure = distinct
    (axis,) = axes_called(figure, f"joint {joint + 1}: path of the journal [µm]")
    wall, path = axis.lines
    assert np.hypot(*wall.get_data()) == pytest.approx(1e6 * trajectory.clearance[joint])
    expected = 1e6 * trajectory.eccentricity[:, joint]
    assert np.array_equal(np.column_stack(path.get_data()), expected)
    (points,) = axis.collections
    assert np.asarray(points.get_offsets()) == pytest.approx(expected)
    assert np.array_equal(points.get_array(), trajectory.time)


@pytest.mark.parametrize("joint", [0, 1])
def test_wear_is_drawn_round_the_surface_that_wears(distinct, joint):
    trajectory, figure = distinct
    (axis,) = axes_called(figure, f"joint {joint + 1}: wear depth")
    bins = trajectory.wear_bearing.shape[1]
    unit = float(re.search(r"10\^\{(-?\d+)\}", axis.get_title())[1])
    drawn = {surface.get_label(): surface.get_xy() for surface in axis.patches}
    assert set(drawn) == {"bearing", "journal"}
    for name, depths in (("bearing", trajectory.wear_bearing), ("journal", trajectory.wear_journal)):
        around, steps = drawn[name][: 2 * bins].T
        middles = 0.5 * (around[::2] + around[1::2])
        assert middles == pytest.approx(2.0 * np.pi * (np.arange(bins) + 0.5) / bins)
        assert steps[::2] == pytest.approx(depths[joint] / 10.0**unit)
        assert np.array_equal(steps[::2], steps[1::2])


def test_deflections_are_drawn_in_millimetres_where_they_are_given(tmp_path, saved_figures):
    trajectory = make_trajectory()
    plot_deployment(trajectory, tmp_path / "figure.png")
    plot_deployment(trajectory, tmp_path / "figure.png", deflections(trajectory))
    without, given = saved_figures
    assert len(given.axes) == len(without.axes) + 1
    bent = curves(given, "deflection of\npanel [mm]")
    assert np.stack(list(bent.values()), axis=1) == pytest.approx(1e3 * deflections(trajectory))


def test_the_energies_show_elastic_energy_and_what_the_material_takes(tmp_path, saved_figures):
    trajectory = make_trajectory()
    plot_deployment(trajectory, tmp_path / "figure.png")
    drawn = curves(saved_figures[0], "energy [J]")
    assert np.array_equal(drawn["elastic"], trajectory.energies["elastic"])
    assert np.array_equal(drawn["in the material"], trajectory.energies["material_dissipation"])
    assert drawn["dissipated"] == pytest.approx(sum(trajectory.energies[name] for name in DISSIPATED))
    for name in ("elastic", "material_dissipation"):
        trajectory.energies[name] = 0.0 * trajectory.time
    plot_deployment(trajectory, tmp_path / "figure.png")
    assert not {"elastic", "in the material"} & set(curves(saved_figures[1], "energy [J]"))


@pytest.mark.parametrize("kept", [5, 7, 8, 10])
def test_the_legend_of_the_energies_covers_no_curve(tmp_path, saved_figures, kept):
    trajectory = make_trajectory()
    for name in (*STORED, *PUT_IN)[kept:]:
        trajectory.energies[name] = 0.0 * trajectory.time
    plot_deployment(trajectory, tmp_path / "figure.png")
    figure = saved_figures[0]
    (axis,) = [axis for axis in figure.axes if axis.get_ylabel() == "energy [J]"]
    legend = axis.get_legend().get_window_extent()
    above, *_ = [other for other in figure.axes if other.get_ylabel() == "cable torque\n[N m]"]
    highest = max(np.max(line.get_ydata()) for line in axis.lines)
    assert axis.transData.transform((0.0, highest))[1] < legend.y0
    assert legend.y1 < above.get_window_extent().y0
    assert legend.x1 < axis.get_window_extent().x1


def compared(tmp_path, name="figure.png", joints=2):
    pair = [make_trajectory(joints), make_trajectory(joints)]
    pair[1].metadata = {"model": "flexible-clearance"}
    pair[1].latch_times = pair[1].latch_times - 1.0
    plot_comparison(pair, [0.0 * deflections(pair[0]), deflections(pair[1])], tmp_path / name)
    return pair


@pytest.mark.parametrize("joints", [1, 3])
def test_a_comparison_has_a_column_for_each_deployment_and_one_scale_a_row(tmp_path, saved_figures, joints):
    compared(tmp_path, joints=joints)
    axes = np.array(saved_figures[0].axes).reshape(joints + 2, 2)
    titles = [axis.get_title() for axis in axes[0]]
    assert [title.split(":")[0] for title in titles] == ["rigid-clearance", "flexible-clearance"]
    assert all("latched at" in title for title in titles)
    for left, right in axes:
        assert "[" in left.get_ylabel()
        assert left.get_ylim() == right.get_ylim()
        assert left.get_xlim() == right.get_xlim()


def test_a_comparison_counts_its_time_from_the_first_latching(tmp_path, saved_figures):
    pair = compared(tmp_path)
    axes = np.array(saved_figures[0].axes).reshape(4, 2)
    for column, trajectory, latching in zip(axes.T, pair, (13.1, 12.1), strict=True):
        for axis in column[1:]:
            assert axis.lines[0].get_xdata() == pytest.approx(trajectory.time - latching)


def test_the_same_comparison_gives_the_same_file(tmp_path):
    for name in ("first.svg", "second.svg"):
        compared(tmp_path, name)
    assert (tmp_path / "first.svg").read_bytes() == (tmp_path / "second.svg").read_bytes()


def test_a_comparison_refuses_what_it_cannot_draw(tmp_path):
    with pytest.raises(ValueError, match=r"\.pdf, \.png, \.svg"):
        compared(tmp_path, "figure.gif")
    open_joints = make_trajectory()
    open_joints.latch_times[:] = np.nan
    with pytest.raises(ValueError, match="no joint of rigid-clearance has latched"):
        plot_comparison([open_joints], [deflections(open_joints)], tmp_path / "figure.png")
    assert list(tmp_path.iterdir()) == []


def test_importing_the_module_does_not_import_matplotlib():
    code = "import sys, solar_env.pictures.plots; print({'matplotlib', 'numba', 'torch'} & set(sys.modules))"
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert printed.strip() == "set()"
