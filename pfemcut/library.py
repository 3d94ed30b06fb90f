"""Libraries of constants: folders ``library`` of packages with one TOML file an entry."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import Any

from pfemcut.inputs import InputError, is_file, nearest, read_toml


def entry_names(package: str) -> list[str]:
    """Names of the entries of a package's library."""
    folder = resources.files(package) / "library"
    return sorted(
        entry.name.removesuffix(".toml") for entry in folder.iterdir() if entry.name.endswith(".toml")
    )


def entry(package: str, name: str, base_directory: Path, key: str, kind: str) -> tuple[dict[str, Any], Path]:
    """The table of an entry of the library, or of a file, and the path it was read from.

    Parameters
    ----------
    package
        Whose library it is.
    name
        An entry, or a path to a TOML file (relative ones start at ``base_directory``).
    base_directory
        Folder of the case file.
    key, kind
        Where the name was given, and what an entry is called, for messages.

    Raises
    ------
    InputError
        If there is no such entry or file.
    """
    if name in entry_names(package):
        with resources.as_file(resources.files(package) / "library" / f"{name}.toml") as path:
            return read_toml(path), path
    path = base_directory / name
    if name.endswith(".toml") or is_file(path):
        return read_toml(path), path
    hint = nearest(name, entry_names(package))
    raise InputError([f"{key}: unknown {kind} '{name}'{hint} (or a path to a .toml file)"])
