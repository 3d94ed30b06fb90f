"""Checkpoints: exact, whole or refused, two deep, and only for the case that wrote them."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from pfemcut.results.checkpoint import (
    HEADER,
    NAME,
    PREVIOUS,
    CheckpointError,
    changed_keys,
    read_checkpoint,
    read_file,
    require_same_case,
    write_checkpoint,
)

CASE = """
title = "a"
[cutting]
speed = 3330.0
travel = 0.1
[output]
directory = "out"
[[body]]
outline = [[0.0, 0.0], [1.0, 0.0]]
"""
STATE = {
    "points": np.array([[0.1, 1 / 3], [np.nextafter(1, 2), -0.0]]),
    "loops/0": np.arange(3),
    "locked": np.array([True, False]),
    "empty": np.empty((0, 4)),
    "time": np.array(1e-7),
}


def test_state_comes_back_bit_for_bit(tmp_path: Path) -> None:
    write_checkpoint(tmp_path / NAME, STATE, CASE, 12)
    found = read_checkpoint(tmp_path)
    assert (found.step, found.resolved_case, found.warnings) == (12, CASE, ())
    assert set(found.state) == set(STATE)
    for name, array in STATE.items():
        back = found.state[name]
        assert (back.dtype, back.shape, back.tobytes()) == (array.dtype, array.shape, array.tobytes())


def test_a_checkpoint_is_an_hdf5_file_behind_its_checksum(tmp_path: Path) -> None:
    write_checkpoint(tmp_path / NAME, STATE, CASE, 12)
    assert (tmp_path / NAME).read_bytes().startswith(b"pfemcut checkpoint\nsha256 ")
    with h5py.File(tmp_path / NAME) as file:
        assert file.userblock_size == HEADER


def test_hdf5_never_sees_a_damaged_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Some single flipped bits crash it, and with it the process.
    write_checkpoint(tmp_path / NAME, STATE, CASE, 12)
    flip_a_bit_of_the_image(tmp_path / NAME)
    monkeypatch.setattr(h5py, "File", lambda *_: pytest.fail("HDF5 was asked"))
    with pytest.raises(CheckpointError, match="damaged"):
        read_file(tmp_path / NAME)


def test_checkpoints_of_earlier_versions_without_a_header_are_read(tmp_path: Path) -> None:
    write_checkpoint(tmp_path / NAME, STATE, CASE, 12)
    with h5py.File(tmp_path / NAME) as new, h5py.File(tmp_path / "old.h5", "w") as old:
        old.attrs.update(new.attrs)
        for name in new:
            new.copy(name, old)
    found = read_file(tmp_path / "old.h5")
    assert found.step == 12
    assert found.state["points"].tobytes() == STATE["points"].tobytes()


def test_the_last_two_are_kept_and_nothing_else(tmp_path: Path) -> None:
    for step in (1, 2, 3):
        write_checkpoint(tmp_path / NAME, STATE, CASE, step)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([NAME, PREVIOUS])
    assert (read_file(tmp_path / NAME).step, read_file(tmp_path / PREVIOUS).step) == (3, 2)


def cut_short(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def flip_a_bit_of_a_field(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        file["state/points"][0, 0] = 0.10000001


def make_foreign(path: Path) -> None:
    path.unlink()
    with h5py.File(path, "w") as file:
        file["a"] = 1


def make_newer(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        file.attrs["version"] = 99


def make_empty(path: Path) -> None:
    path.write_bytes(b"")


def flip_a_bit_of_the_image(path: Path) -> None:
    image = bytearray(path.read_bytes())
    image[HEADER + 100] ^= 4
    path.write_bytes(image)


def flip_a_bit_of_the_header(path: Path) -> None:
    image = bytearray(path.read_bytes())
    image[30] ^= 4
    path.write_bytes(image)


DAMAGES = [
    cut_short,
    flip_a_bit_of_a_field,
    flip_a_bit_of_the_image,
    flip_a_bit_of_the_header,
    make_foreign,
    make_newer,
    make_empty,
]


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_checkpoint_gives_way_to_the_previous_one(tmp_path: Path, damage) -> None:
    write_checkpoint(tmp_path / NAME, STATE, CASE, 1)
    write_checkpoint(tmp_path / NAME, STATE, CASE, 2)
    damage(tmp_path / NAME)
    found = read_checkpoint(tmp_path)
    assert found.step == 1
    assert NAME in found.warnings[0]


@pytest.mark.parametrize("damage", DAMAGES)
def test_with_no_usable_checkpoint_one_error_names_the_file(tmp_path: Path, damage) -> None:
    write_checkpoint(tmp_path / NAME, STATE, CASE, 1)
    damage(tmp_path / NAME)
    with pytest.raises(CheckpointError, match="checkpoint.h5"):
        read_checkpoint(tmp_path)


def test_a_kill_between_the_two_renames_leaves_the_previous_one(tmp_path: Path) -> None:
    write_checkpoint(tmp_path / NAME, STATE, CASE, 1)
    (tmp_path / NAME).rename(tmp_path / PREVIOUS)
    assert read_checkpoint(tmp_path).step == 1


def test_no_checkpoint_is_said_plainly(tmp_path: Path) -> None:
    with pytest.raises(CheckpointError, match="no checkpoint to resume"):
        read_checkpoint(tmp_path)


def test_text_in_the_state_is_refused_when_written_not_when_read(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="name"):
        write_checkpoint(tmp_path / NAME, {"name": np.array("x")}, CASE, 1)


def test_travel_and_output_may_change_on_resume() -> None:
    wanted = CASE.replace("travel = 0.1", "travel = 0.2").replace('"out"', '"elsewhere"\nevery = 5')
    require_same_case(CASE, wanted)


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("speed = 3330.0", "speed = 3000.0", "cutting.speed"),
        ("speed = 3330.0", "", "cutting.speed"),
        ("speed = 3330.0", "speed = 3330.0\ndepth = 0.1", "cutting.depth"),
        ("[1.0, 0.0]]", "[2.0, 0.0]]", "body[0].outline[1]"),
        ('"a"', '"b"', "title"),
    ],
)
def test_anything_else_is_refused_by_its_key(old: str, new: str, key: str) -> None:
    wanted = CASE.replace(old, new)
    assert [text.split(":")[0] for text in changed_keys(CASE, wanted)] == [key]
    with pytest.raises(CheckpointError, match="travel, output"):
        require_same_case(CASE, wanted)
