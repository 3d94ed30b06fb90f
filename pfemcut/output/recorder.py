"""Writes what a run leaves in its output directory while it goes: history, timing, fields, checkpoints."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import TracebackType

from pfemcut.method import Frame, Measures
from pfemcut.output.directory import CONTACT, HISTORY, INPUTS, TIMING, writing
from pfemcut.output.vtu import FieldWriter
from pfemcut.results.checkpoint import NAME, State, write_checkpoint
from pfemcut.results.contact_table import append_contact
from pfemcut.results.derived.tool_profiles import ToolLoads
from pfemcut.results.history import TableWriter, history_row, truncate_table


class Recorder:
    """The writers of one output directory.

    Parameters
    ----------
    directory
        A prepared output directory.
    inputs
        Resolved case (TOML text).
    last_step
        Step of the checkpoint that the run goes on from; what was written after it is dropped. -1 for a fresh run.
    """

    def __init__(self, directory: Path, inputs: str, last_step: int = -1) -> None:
        self._directory = directory
        self._inputs = inputs
        self._frame_step = -1
        self._checkpoint_step = last_step
        with writing(directory):
            (directory / INPUTS).write_text(inputs, encoding="utf-8")
            truncate_table(directory / HISTORY, last_step)
            truncate_table(directory / TIMING, last_step)
            truncate_table(directory / CONTACT, last_step)
            self._fields = FieldWriter(directory, last_step)
            self._history = TableWriter(directory / HISTORY)
            self._timing = TableWriter(directory / TIMING)

    def row(self, measures: Measures, own: Mapping[str, float]) -> None:
        """Append a history row."""
        with writing(self._directory):
            self._history.append(history_row(measures, own))

    def contact(self, step: int, loads: ToolLoads) -> None:
        """Append what the tool's surface feels after a step."""
        with writing(self._directory):
            append_contact(self._directory / CONTACT, step, loads)

    def times(self, step: int, seconds: Mapping[str, float]) -> None:
        """Append the wall times (s) of a step by phase."""
        with writing(self._directory):
            self._timing.append({"step": step, **seconds})

    def frame(self, frame: Frame) -> None:
        """Write the fields, unless this step's are written."""
        if frame.step != self._frame_step:
            with writing(self._directory):
                self._fields.write(frame)
            self._frame_step = frame.step

    def checkpoint(self, step: int, state: State) -> None:
        """Write a checkpoint, unless this step's is written."""
        if step != self._checkpoint_step:
            with writing(self._directory):
                write_checkpoint(self._directory / NAME, state, self._inputs, step)
            self._checkpoint_step = step

    def close(self) -> None:
        """Close the tables."""
        self._history.close()
        self._timing.close()

    def __enter__(self) -> Recorder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
