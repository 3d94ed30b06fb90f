"""Checkpoints: everything a method needs to go on, in one HDF5 file that is either whole or refused.

Two are kept, so that a machine that dies while it writes costs at most the steps between two checkpoints.
"""

from __future__ import annotations

import hashlib
import io
import os
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from pfemcut.inputs import UserError

State = Mapping[str, NDArray[np.generic]]

FORMAT = "pfemcut checkpoint"
VERSION = 4
NAME = "checkpoint.h5"
PREVIOUS = "checkpoint.previous.h5"

HEADER = 512
"""Bytes before the HDF5 part (its user block), which hold the checksum of that part."""
_SIGNATURE = b"\x89HDF\r\n\x1a\n"

FREE_TO_CHANGE = ("cutting.travel", "after", "output", "tool.wear")
"""Keys (or whole tables) of a case that may differ on resume. The number of ranks is no part of a case."""


class CheckpointError(UserError):
    """A checkpoint that is missing, damaged, of another program, or of another case."""


@dataclass(frozen=True)
class Checkpoint:
    """A checkpoint as read.

    Attributes
    ----------
    path
        The file it came from.
    step
        Last finished step.
    resolved_case
        The resolved case (TOML text) of the run that wrote it.
    state
        Arrays by name, as given to :func:`write_checkpoint`.
    warnings
        What was wrong with a newer file that had to be passed over.
    """

    path: Path
    step: int
    resolved_case: str
    state: State
    warnings: tuple[str, ...] = ()


def write_checkpoint(path: Path, state: State, resolved_case: str, step: int) -> None:
    """Write a checkpoint to ``path``; the one there becomes ``checkpoint.previous.h5``.

    Written to a temporary file, synced and renamed, so ``path`` never names half a file.

    Parameters
    ----------
    path
        The file, usually ``DIRECTORY/checkpoint.h5``.
    state
        Numbers and booleans of any shape by name.
    resolved_case
        The resolved case as TOML text.
    step
        Last finished step.
    """
    arrays = {name: np.asarray(value) for name, value in state.items()}
    bad = [name for name, array in arrays.items() if array.dtype.kind not in "biufc"]
    if bad:
        raise TypeError(f"checkpoint state must be numbers or booleans: {', '.join(bad)}")
    temporary = path.with_name(path.name + ".tmp")
    try:
        with temporary.open("wb") as file:
            file.write(_image(arrays, resolved_case, step))
            file.flush()
            os.fsync(file.fileno())
    except OSError:
        temporary.unlink(missing_ok=True)
        raise
    if path.exists():
        os.replace(path, path.with_name(PREVIOUS))
    os.replace(temporary, path)
    _sync(path.parent)


def read_checkpoint(directory: Path) -> Checkpoint:
    """Read the newest valid checkpoint of a directory.

    Raises
    ------
    CheckpointError
        If there is none; the message says what is wrong with each file.
    """
    troubles: list[str] = []
    for name in (NAME, PREVIOUS):
        path = directory / name
        if not path.exists():
            continue
        try:
            found = read_file(path)
        except CheckpointError as error:
            troubles.append(str(error))
            continue
        passed_over = tuple(f"{trouble}; {PREVIOUS} is used instead" for trouble in troubles)
        return Checkpoint(found.path, found.step, found.resolved_case, found.state, passed_over)
    if troubles:
        raise CheckpointError("no usable checkpoint: " + "; ".join(troubles))
    raise CheckpointError(f"{directory}: there is no checkpoint to resume from")


def read_file(path: Path) -> Checkpoint:
    """Read one checkpoint file and check that it is whole."""
    _require_whole(path)
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != FORMAT:
                raise CheckpointError(f"{path}: not a {FORMAT}")
            version = int(file.attrs["version"])
            if version != VERSION:
                raise CheckpointError(f"{path}: format version {version}; this program reads {VERSION}")
            step = int(file.attrs["step"])
            digest = str(file.attrs["digest"])
            case = file["case"].asstr()[()]
            arrays = {name: np.asarray(dataset[()]) for name, dataset in _datasets(file["state"])}
    except (OSError, KeyError, ValueError, RuntimeError, AttributeError, TypeError, MemoryError) as error:
        # h5py answers damage with any of these, and with messages about its own internals.
        raise CheckpointError(f"{path}: damaged, or not an HDF5 file") from error
    if digest != _digest(arrays, case, step):
        raise CheckpointError(f"{path}: damaged (its checksum doesn't match)")
    return Checkpoint(path, step, case, arrays)


def _require_whole(path: Path) -> None:
    """Raise :class:`CheckpointError` for a damaged file before HDF5 sees it: that can crash the process.

    Files of earlier versions, which begin with HDF5's signature, have no such checksum and pass.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise CheckpointError(f"{path}: can't be read: {error.strerror}") from error
    if not data.startswith(_SIGNATURE) and data[:HEADER] != _header(data[HEADER:]):
        raise CheckpointError(f"{path}: damaged, or not a {FORMAT}")


def _header(image: bytes) -> bytes:
    """What stands before the HDF5 part ``image`` of a checkpoint."""
    return f"{FORMAT}\nsha256 {hashlib.sha256(image).hexdigest()}\n".encode().ljust(HEADER, b"\0")


def changed_keys(stored: str, wanted: str) -> tuple[str, ...]:
    """List what a resume may not change: one text ``key: stored -> wanted`` for each offending key.

    Parameters
    ----------
    stored, wanted
        Resolved cases as TOML text: the checkpoint's and the new one.
    """
    old, new = dict(_leaves(tomllib.loads(stored))), dict(_leaves(tomllib.loads(wanted)))
    keys = [*old, *(key for key in new if key not in old)]
    return tuple(
        f"{key}: {_shown(old, key)} -> {_shown(new, key)}"
        for key in keys
        if not _free(key) and _shown(old, key) != _shown(new, key)
    )


def require_same_case(stored: str, wanted: str) -> None:
    """Raise :class:`CheckpointError`, naming the keys, if a resume would change more than it may."""
    changes = changed_keys(stored, wanted)
    if changes:
        raise CheckpointError(
            "only travel, output, [after], wear constants and the number of ranks may change on resume, but: "
            + "; ".join(changes)
        )


def require_still_cutting(stored: str, wanted: str, time: float) -> None:
    """Raise :class:`CheckpointError` if a tool that has withdrawn would cut on, or one that cuts has come too far.

    What a tool has cut beyond a shorter travel can't be undone before it withdraws.

    Parameters
    ----------
    stored, wanted
        Resolved cases (TOML text) of the checkpoint and of the run.
    time
        Of the checkpoint (s).
    """
    before, now = tomllib.loads(stored), tomllib.loads(wanted)
    if "after" in before and _beyond(before, time):
        if before["cutting"]["travel"] != now["cutting"]["travel"] or before["after"] != now.get("after"):
            raise CheckpointError("the tool has withdrawn: neither travel nor [after] may change any more")
    elif "after" in now and _beyond(now, time):
        cutting = now["cutting"]
        raise CheckpointError(
            f"the tool has cut {time * cutting['speed']:.6g} mm, more than travel = {cutting['travel']:g} mm: "
            "with [after] it can't be less"
        )


def _beyond(case: Mapping[str, Any], time: float) -> bool:
    """Whether ``time`` (s) is after the end of the cut."""
    return bool(time > case["cutting"]["travel"] / case["cutting"]["speed"] * (1.0 + 1e-9))


def _free(key: str) -> bool:
    return any(key == name or key.startswith(name + ".") for name in FREE_TO_CHANGE)


def _shown(leaves: Mapping[str, Any], key: str) -> str:
    return repr(leaves[key]) if key in leaves else "(not set)"


def _leaves(value: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for name, item in value.items():
            yield from _leaves(item, f"{key}.{name}" if key else name)
    elif isinstance(value, list) and any(isinstance(item, (dict, list)) for item in value):
        for index, item in enumerate(value):
            yield from _leaves(item, f"{key}[{index}]")
    else:
        yield key, value


def _datasets(group: h5py.Group, prefix: str = "") -> Iterator[tuple[str, h5py.Dataset]]:
    for name, item in group.items():
        if isinstance(item, h5py.Group):
            yield from _datasets(item, f"{prefix}{name}/")
        else:
            yield prefix + name, item


def _digest(arrays: State, case: str, step: int) -> str:
    """SHA-256 of all that a checkpoint holds; HDF5 itself doesn't notice flipped bits."""
    total = hashlib.sha256(f"{VERSION} {step} {case}".encode())
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        total.update(f"{name} {array.dtype.str} {arrays[name].shape}".encode())
        total.update(array.tobytes())
    return total.hexdigest()


def _image(arrays: State, resolved_case: str, step: int) -> bytes:
    """Return the HDF5 file as bytes.

    HDF5 builds it in memory because it crashes the process when a disk fills under an open file.
    """
    image = io.BytesIO()
    with h5py.File(image, "w", userblock_size=HEADER) as file:
        file.attrs["format"] = FORMAT
        file.attrs["version"] = VERSION
        file.attrs["step"] = step
        file.attrs["digest"] = _digest(arrays, resolved_case, step)
        file.create_dataset("case", data=resolved_case, dtype=h5py.string_dtype())
        group = file.create_group("state")
        for name, array in arrays.items():
            group.create_dataset(name, data=array)
    content = image.getvalue()[HEADER:]
    return _header(content) + content


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
