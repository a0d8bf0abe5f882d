"""Files from anywhere are read, or refused by a ValueError: nothing is executed or inflated unseen."""

import io
import pickle
import zipfile

import numpy as np
import pytest

from solar_env.support.plain_arrays import parse_json, read_arrays, read_json


class Trap:
    """Runs when the object is unpickled."""

    def __reduce__(self):
        return pytest.fail, ("a stranger's file was executed",)


def npy(array):
    file = io.BytesIO()
    np.save(file, array, allow_pickle=True)
    return file.getvalue()


def archive(path, **members):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in members.items():
            file.writestr(f"{name}.npy", content)
    return path


def anything(name):
    return True


def test_plain_arrays_come_back_as_numpy_reads_them(tmp_path):
    arrays = {
        "whole": np.arange(6, dtype=np.int64),
        "by_columns": np.asfortranarray(np.arange(6.0).reshape(2, 3)),
        "text": np.array("a text"),
        "none": np.zeros((0, 3)),
        "table": np.zeros(2, dtype=[("joint", "i8"), ("time", "f8")]),
    }
    for save in (np.savez, np.savez_compressed):
        with open(tmp_path / "file.npz", "wb") as file:
            save(file, **arrays)
        found = read_arrays(tmp_path / "file.npz", anything)
        assert list(found) == list(arrays)
        for name, array in arrays.items():
            assert (found[name].dtype, found[name].shape) == (array.dtype, array.shape)
            assert found[name].tobytes() == array.tobytes()
            assert found[name].flags.writeable


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (npy(np.array([Trap()], dtype=object)), "Object arrays"),
        (npy(np.zeros(3))[:-1], "EOF"),
        (npy(np.zeros(3)).replace(b"(3,), }", b"(-3,),}"), "negative|shape"),
        (npy(np.zeros(3)).replace(b"\x93NUMPY\x01", b"\x93NUMPY\x07"), "format|magic"),
    ],
)
def test_members_that_are_no_plain_arrays_are_refused(tmp_path, content, message):
    path = archive(tmp_path / "file.npz", one=content)
    with pytest.raises(ValueError, match=message):
        read_arrays(path, anything)


@pytest.mark.parametrize("content", [b"", pickle.dumps(Trap()), npy(np.zeros(3))])
def test_files_that_are_no_archives_are_refused(tmp_path, content):
    (tmp_path / "file.npz").write_bytes(content)
    with pytest.raises(ValueError, match=r"\w"):
        read_arrays(tmp_path / "file.npz", anything)


def test_a_member_that_does_not_belong_there_is_refused_before_it_is_read(tmp_path):
    path = archive(tmp_path / "file.npz", **{"../../evil": npy(np.zeros(1))})
    with pytest.raises(ValueError, match=r"it holds '../../evil', which does not belong there"):
        read_arrays(path, {"time"}.__contains__)


def test_a_small_file_that_would_become_a_large_one_is_not_inflated(tmp_path):
    path = archive(tmp_path / "file.npz", one=npy(np.zeros(2_000_000)))
    assert path.stat().st_size < 50_000
    with pytest.raises(ValueError, match="it holds 16,000,128 bytes, more than the 1,000,000 that are read"):
        read_arrays(path, anything, most_bytes=1_000_000)


@pytest.mark.parametrize("content", ["", "{", "[" * 100_000, '"\\ud800', b"\xff\xfe{", "nul"])
def test_text_that_is_no_json_is_refused(tmp_path, content):
    with pytest.raises(ValueError, match="it is no JSON"):
        parse_json(content)


def test_a_json_file_is_read_to_a_bound(tmp_path, monkeypatch):
    path = tmp_path / "file.json"
    path.write_text('{"a": 1}')
    assert read_json(path) == {"a": 1}
    monkeypatch.setattr("solar_env.support.plain_arrays._LONGEST_JSON", 4)
    with pytest.raises(ValueError, match=r"file\.json is longer than the 4 bytes"):
        read_json(path)
