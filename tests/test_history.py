"""The history table: readable while it grows, exact to the bit, and cut back to a checkpoint."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pfemcut.method import Measures
from pfemcut.results.history import (
    CORE_COLUMNS,
    HistoryError,
    TableWriter,
    as_text,
    history_row,
    read_table,
    truncate_table,
)

MEASURES = Measures(1, 1e-7, 1e-7, 3.3e-4, 120.0, 40.0, 0.0, 293.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 900)


def write(path: Path, steps: range) -> None:
    with TableWriter(path) as table:
        for step in steps:
            row = history_row(replace(MEASURES, step=step, cutting_force=step / 3.0), {"outside": step})
            table.append(row)


def test_core_columns_come_first_and_in_the_order_of_the_contract(tmp_path: Path) -> None:
    write(tmp_path / "history.csv", range(1, 3))
    header = (tmp_path / "history.csv").read_text().splitlines()[0]
    assert header == (
        "step,time,dt,travel,cutting_force,thrust_force,contact_length,max_temperature,max_eqps,tool_work,"
        "plastic_work,friction_work,elastic_energy,kinetic_energy,energy_error,nodes,outside"
    )
    assert header.startswith(",".join(CORE_COLUMNS))


def test_every_row_is_on_disk_before_the_next_step(tmp_path: Path) -> None:
    table = TableWriter(tmp_path / "h.csv")
    table.append({"step": 1, "a": 0.5})
    assert read_table(tmp_path / "h.csv")["a"].tolist() == [0.5]
    table.close()


@given(st.floats(allow_nan=False, allow_infinity=True))
def test_floats_read_back_to_the_same_bits(value: float) -> None:
    assert np.float64(as_text(np.float64(value))).tobytes() == np.float64(value).tobytes()


def test_a_history_cut_back_and_continued_is_byte_for_byte_the_uninterrupted_one(tmp_path: Path) -> None:
    whole, resumed = tmp_path / "whole.csv", tmp_path / "resumed.csv"
    write(whole, range(1, 21))
    write(resumed, range(1, 16))
    assert truncate_table(resumed, 10) == 10
    write(resumed, range(11, 21))
    assert resumed.read_bytes() == whole.read_bytes()


def test_a_half_written_line_is_dropped(tmp_path: Path) -> None:
    path = tmp_path / "h.csv"
    write(path, range(1, 6))
    path.write_bytes(path.read_bytes()[:-7])
    assert read_table(path)["step"].tolist() == [1, 2, 3, 4]
    assert truncate_table(path, 5) == 4
    write(path, range(5, 6))
    assert read_table(path)["step"].tolist() == [1, 2, 3, 4, 5]


def test_a_row_with_other_columns_is_refused_by_name(tmp_path: Path) -> None:
    with TableWriter(tmp_path / "h.csv") as table:
        table.append({"step": 1, "a": 0.5})
        with pytest.raises(HistoryError, match="b"):
            table.append({"step": 2, "b": 0.5})


def test_own_columns_may_not_hide_core_columns() -> None:
    with pytest.raises(HistoryError, match="travel"):
        history_row(MEASURES, {"travel": 1.0})
