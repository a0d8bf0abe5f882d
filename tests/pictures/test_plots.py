import re
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from solar_env.pictures.plots import DISSIPATED, PUT_IN, STORED, plot_deployment

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


def figure_of(trajectory, deflections=None):
    """The figure of a trajectory, which is not rendered."""
    figures = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("solar_env.pictures.plots.save_figure", lambda figure, *_, **__: figures.append(figure))
        plot_deployment(trajectory, "figure.png", deflections)
    return figures[0]


def axes_called(figure, start):
    """The axes whose label or title begins so."""
    return [axis for axis in figure.axes if axis.get_ylabel().startswith(start) or axis.get_title().startswith(start)]


def energy_curves(figure):
    (axis,) = axes_called(figure, "energy [J]")
    return {line.get_label(): line.get_ydata() for line in axis.lines}


@pytest.mark.parametrize(("suffix", "start"), [(".png", b"\x89PNG"), (".svg", b"<?xml")])
def test_each_suffix_gives_a_file_of_its_format_even_where_nothing_happened(tmp_path, suffix, start):
    trajectory = make_trajectory(joints=1)
    trajectory.contacts = trajectory.contacts[:0]
    trajectory.normal_force[:] = 0.0
    trajectory.wear_bearing[:] = 0.0
    trajectory.latch_times[:] = np.nan
    plot_deployment(trajectory, tmp_path / f"figure{suffix}")
    assert (tmp_path / f"figure{suffix}").read_bytes().startswith(start)


def test_another_suffix_is_refused_and_nothing_written(tmp_path):
    with pytest.raises(ValueError, match="Format 'xyz' is not supported"):
        plot_deployment(make_trajectory(), tmp_path / "figure.xyz")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("joints", "clearance"), [(1, 2e-4), (3, 2e-4), (2, 0.0)])
def test_every_joint_has_its_force_and_with_clearance_path_and_wear_and_axes_name_their_units(joints, clearance):
    figure = figure_of(make_trajectory(joints, clearance))
    assert len(axes_called(figure, "contact force" if clearance else "joint force")) == joints
    assert sum(axis.name == "polar" for axis in figure.axes) == (joints if clearance else 0)
    labels = [axis.get_ylabel() + axis.get_title() + axis.get_xlabel() for axis in figure.axes]
    assert [label for label in labels if "[" not in label] == []


@pytest.fixture(scope="module")
def distinct():
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
    return trajectory, figure_of(trajectory, trajectory.angles)


@pytest.mark.parametrize(
    ("label", "values"),
    [
        ("angle [deg]", lambda trajectory: np.degrees(trajectory.angles)),
        ("latch torque\n[N m]", lambda trajectory: trajectory.latch_torque),
        ("cable torque\n[N m]", lambda trajectory: trajectory.cable_torque),
        ("deflection of\npanel [mm]", lambda trajectory: 1e3 * trajectory.angles),
    ],
)
def test_angles_torques_and_deflections_are_drawn_in_their_units_under_their_own_names(distinct, label, values):
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


def test_the_force_of_each_joint_is_drawn_with_the_peaks_of_its_own_contacts_inside_the_axes(distinct):
    trajectory, figure = distinct
    forces = axes_called(figure, "contact force")
    for joint, (axis, start, peak) in enumerate(zip(forces, (13.1, 2.0), (700.0, 40.0), strict=True)):
        assert axis.get_ylabel() == f"contact force\njoint {joint + 1} [N]"
        assert np.array_equal(axis.lines[0].get_ydata(), trajectory.normal_force[:, joint])
        (stem,) = axis.collections[0].get_segments()
        assert stem[-1].tolist() == [start, peak]
        assert trajectory.normal_force.max() < peak < axis.get_ylim()[1]


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


def test_the_energies_show_elastic_energy_and_what_the_material_takes_where_there_is_any(distinct):
    trajectory, figure = distinct
    drawn = energy_curves(figure)
    assert np.array_equal(drawn["elastic"], trajectory.energies["elastic"])
    assert np.array_equal(drawn["in the material"], trajectory.energies["material_dissipation"])
    assert drawn["dissipated"] == pytest.approx(sum(trajectory.energies[name] for name in DISSIPATED))
    rigid = make_trajectory()
    for name in ("elastic", "material_dissipation"):
        rigid.energies[name] = 0.0 * rigid.time
    assert not {"elastic", "in the material"} & set(energy_curves(figure_of(rigid)))


def test_importing_the_module_does_not_import_matplotlib():
    code = "import sys, solar_env.pictures.plots; print({'matplotlib', 'numba', 'torch'} & set(sys.modules))"
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert printed.strip() == "set()"
