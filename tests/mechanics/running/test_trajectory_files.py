"""Trajectories come back from their files as they were, and other files are refused by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mechanisms import pendulum

from solar_env.array.deployment import simulate as simulate_deployment
from solar_env.mechanics.running.simulation import simulate
from solar_env.mechanics.running.trajectory import Trajectory

RIGID: dict[str, Any] = {"model": "rigid-clearance"}


MODAL: dict[str, Any] = {"model": "flexible-clearance:4 modes"}


@pytest.fixture(scope="module", params=[RIGID, MODAL], ids=["rigid", "modal"])
def run(request: pytest.FixtureRequest) -> Trajectory:
    return simulate_deployment(**request.param, duration=2.0)


def test_a_saved_trajectory_loads_as_it_was(run: Trajectory, tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    run.save(path)
    loaded = Trajectory.load(path)
    for item in fields(Trajectory):
        mine, theirs = getattr(run, item.name), getattr(loaded, item.name)
        if item.name == "energies":
            assert set(mine) == set(theirs)
            for name in mine:
                assert mine[name].tobytes() == theirs[name].tobytes(), name
        elif item.name == "metadata":
            assert mine == theirs
        else:
            assert mine.dtype == theirs.dtype, item.name
            assert mine.tobytes() == theirs.tobytes(), item.name
    assert loaded.summary() == run.summary()


def test_a_name_without_suffix_is_kept(run: Trajectory, tmp_path: Path) -> None:
    run.save(str(tmp_path / "run"))
    assert [path.name for path in tmp_path.iterdir()] == ["run"]
    assert Trajectory.load(str(tmp_path / "run")).summary() == run.summary()


FOREIGN: dict[str, Callable[[Path], object]] = {
    "another npz": lambda path: np.savez(path, time=np.zeros(3)),
    "a single array": lambda path: path.write_bytes(np.lib.format.magic(1, 0) + bytes(80)),
    "text": lambda path: path.write_text("time,angle\n0,1\n"),
    "nothing": Path.touch,
}


@pytest.mark.parametrize("write", FOREIGN.values(), ids=FOREIGN.keys())
def test_a_foreign_file_is_refused_by_name_and_an_npz_with_what_it_lacks(
    write: Callable[[Path], object], tmp_path: Path
) -> None:
    path = tmp_path / "foreign.npz"
    write(path)
    with pytest.raises(ValueError, match=r"foreign\.npz is not a saved trajectory") as caught:
        Trajectory.load(path)
    if write is FOREIGN["another npz"]:
        assert "it lacks coordinates, velocities, angles" in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"other": np.ones(2)}, "it holds 'other', which does not belong there"),
        ({"angles": np.zeros((3, 2))}, r"angles has the shape \(3, 2\), which does not fit"),
        ({"time": np.zeros((3, 1))}, "has the shape"),
        ({"peak_force": np.zeros(2, dtype=np.float32)}, "peak_force is of the type float32; expected float64"),
        ({"contacts": np.zeros(3)}, "contacts is of the type float64"),
        ({"metadata": np.array("[1]")}, "its metadata are no mapping"),
        ({"metadata": np.array("[" * 100_000)}, "it is no JSON"),
        ({"energies/kinetic": np.zeros(2)}, r"energies/kinetic has the shape \(2,\)"),
        ({"energies/spring": None}, "it lacks the energies spring"),
        ({"wear_journal": np.zeros((2, 0)), "wear_bearing": np.zeros((2, 0))}, "no bins of wear"),
        ({"wear_bearing": np.zeros(2)}, "no bins of wear"),
    ],
)
def test_a_file_with_arrays_of_other_types_or_shapes_is_refused(
    run: Trajectory, tmp_path: Path, changes: dict[str, Any], message: str
) -> None:
    run.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as data:
        arrays = {**data, **changes}
    np.savez(tmp_path / "run.npz", **{name: array for name, array in arrays.items() if array is not None})
    with pytest.raises(ValueError, match=rf"run\.npz is not a saved trajectory: .*{message}"):
        Trajectory.load(tmp_path / "run.npz")


def test_a_run_without_contacts_has_an_empty_table_of_them(tmp_path: Path) -> None:
    run = simulate(pendulum(), 0.1)
    assert len(run.contacts) == 0
    run.save(tmp_path / "run.npz")
    loaded = Trajectory.load(tmp_path / "run.npz")
    assert loaded.contacts.dtype == run.contacts.dtype
