"""``pfemcut compare``: its options, and what it prints."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pfemcut.cli.options import names_in
from pfemcut.cli.speech import say
from pfemcut.inputs import InputError, nearest

if TYPE_CHECKING:
    from pfemcut.compare.table import Comparison

FILES = {".csv", ".json", ".md", ".png"}
"""What is written: into one file by its ending, or all of them into a folder."""


def compare(
    paths: Annotated[
        list[Path],
        typer.Argument(
            metavar="DIR... [TABLE.toml] [MEASURED.csv]",
            help="Folders of runs, published tables, measured figures or curves.",
            show_default=False,
        ),
    ],
    reference: Annotated[
        Path | None,
        typer.Option(
            "--reference",
            metavar="PATH",
            help="Which of them differences are taken from; the first run, or with one run the first table.",
        ),
    ] = None,
    figures: Annotated[
        str, typer.Option("--figures", metavar="NAME,NAME,...", help="Figures to compare, or 'all'.")
    ] = "",
    output: Annotated[
        list[Path],
        typer.Option(
            "-o", "--output", metavar="PATH", help="File (.csv, .md, .json, .png) or folder; repeat at will."
        ),
    ] = [],  # noqa: B006 (typer copies it)
) -> None:
    """Put runs beside each other, published tables and measurements."""
    from pfemcut.compare.sources import read_sources
    from pfemcut.compare.table import chosen_figures, compared, notes_of, text_table
    from pfemcut.output.tables import print_table
    from pfemcut.results.published import ALWAYS_SHOWN

    for path in output:
        if path.suffix and path.suffix not in FILES and not path.is_dir():
            raise InputError([f"-o: given '{path}', must be a folder or end with {', '.join(sorted(FILES))}"])
    at = _reference(paths, reference)
    sources = read_sources(paths)
    if len(sources) < 2:
        raise InputError(["give at least two folders or files to compare"])
    wanted = names_in(figures)
    comparison = compared(sources, at, chosen_figures(sources, wanted, ALWAYS_SHOWN))
    if not comparison.rows:
        raise InputError(["there is no figure to compare"])
    header, rows = text_table(comparison)
    print_table(f"differences from {sources[at].label}", header, rows, texts=2)
    for text in notes_of(comparison):
        say(text)
    for path in output:
        for written in _write(path, comparison):
            say(str(written))


def _reference(paths: Sequence[Path], given: Path | None) -> int:
    """Number of the source that differences are taken from."""
    if given is not None:
        known = [path.resolve() for path in paths]
        if given.resolve() not in known:
            raise InputError(
                [f"--reference: '{given}' is not compared{nearest(str(given), map(str, paths))}"]
            )
        return known.index(given.resolve())
    runs = [index for index, path in enumerate(paths) if path.is_dir()]
    tables = [index for index, path in enumerate(paths) if not path.is_dir()]
    # One run beside a table asks how far the run is from the table.
    return tables[0] if len(runs) < 2 and tables else runs[0]


def _write(path: Path, comparison: Comparison) -> list[Path]:
    from pfemcut.compare.plot import write_plot
    from pfemcut.compare.table import as_json, markdown, write_table
    from pfemcut.output.directory import writing
    from pfemcut.validation.provenance import provenance
    from pfemcut.whole_files import write_json, write_text

    def as_markdown(to: Path) -> None:
        write_text(to, markdown(comparison))

    writers = {
        ".csv": lambda to: write_table(to, comparison),
        ".json": lambda to: write_json(to, {**as_json(comparison), "recorded": provenance()}),
        ".md": as_markdown,
        ".png": lambda to: write_plot(to, comparison),
    }
    one = path.suffix in writers and not path.is_dir()
    targets = [path] if one else [path / f"compare{suffix}" for suffix in writers]
    with writing(path):
        for target in targets:
            target.parent.mkdir(parents=True, exist_ok=True)
            writers[target.suffix](target)
    return targets
