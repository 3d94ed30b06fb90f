"""Tables of the energy and heat ledgers at the end of a run; docs/energy_ledger.md defines every column."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.output.report.text import significant

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Account:
    """One column of a ledger: its name in the history, what it is called, and what it is."""

    column: str
    label: str
    meaning: str


@dataclass(frozen=True)
class LedgerRow:
    """An account with its amount (mJ/mm) and its share of what came in, as text."""

    label: str
    value: str
    share: str
    meaning: str


ENERGY_IN = (
    Account("tool_work", "Work of the tool", "force of the tool on the workpiece along the tool's way"),
    Account("boundary_work", "Work of supports and loads", "prescribed motions and loads on the body"),
)
ENERGY_OUT = (
    Account("plastic_work", "Plastic work", "dissipated by plastic flow"),
    Account("friction_work", "Friction", "shear force times sliding"),
    Account("elastic_energy", "Elastic energy", "stored now"),
    Account("contact_energy", "Contact springs", "stored in the penalty contact"),
    Account("fracture_energy", "Broken bonds", "what they held when they broke"),
    Account("damping_energy", "Dashpots", "dissipated beside the bonds"),
    Account("thermoelastic_work", "Thermoelastic work", "of the pressure on the thermal expansion"),
    Account("remeshing_energy", "Remeshing", "stored energy after less before each transfer"),
)
ENERGY_KINETIC = Account(
    "kinetic_energy", "Kinetic energy", "now; counted only with inertia, else for information"
)
ENERGY_TOLD = (
    ENERGY_KINETIC,
    Account(
        "stabilisation_work", "Pressure projection", "for information: it explains a part of what is left"
    ),
)
HEAT_IN = (
    Account(
        "heat_generated", "Generated", "plastic work's share that heats, and friction's into the workpiece"
    ),
    Account("heat_supplied", "Supplied", "through boundaries with a given flux or temperature"),
)
HEAT_OUT = (
    Account("heat_content", "Content of the workpiece", "above its initial temperature"),
    Account("heat_to_tool", "Conducted into the tool", "through the interface, without friction's share"),
)
HEAT_TOLD = (
    Account("heat_remeshing", "Remeshing", "for information: part of what is left"),
    Account("tool_heat_content", "Content of the tool", "for information: above its initial temperature"),
    Account("tool_heat_lost", "From the tool into its holder", "for information"),
)


@dataclass(frozen=True)
class Ledger:
    """A ledger as a table: what came in, where it went, what is left, and what is told beside it."""

    income: tuple[LedgerRow, ...]
    outgo: tuple[LedgerRow, ...]
    left: LedgerRow
    told: tuple[LedgerRow, ...]


def energy_ledger(history: Mapping[str, Array], *, inertia: bool) -> Ledger:
    """Return the energy ledger of the last history row; with ``inertia`` kinetic energy counts."""
    kinetic = (ENERGY_KINETIC,) if inertia else ()
    told = [each for each in ENERGY_TOLD if each not in kinetic]
    return _ledger(history, ENERGY_IN, (*ENERGY_OUT, *kinetic), told)


def heat_ledger(history: Mapping[str, Array]) -> Ledger:
    """Return the heat ledger of the last history row."""
    return _ledger(history, HEAT_IN, HEAT_OUT, HEAT_TOLD)


def _ledger(
    history: Mapping[str, Array],
    income: tuple[Account, ...],
    outgo: tuple[Account, ...],
    told: list[Account] | tuple[Account, ...],
) -> Ledger:
    def amount(account: Account) -> float:
        return float(history[account.column][-1]) if account.column in history else 0.0

    total = sum(map(amount, income))
    left = total - sum(map(amount, outgo))

    def row(label: str, value: float, meaning: str) -> LedgerRow:
        # Round-off has no sign.
        share = f"{value / total:.2%}".replace("-0.00%", "0.00%") if total else ""
        return LedgerRow(label, significant(value), share, meaning)

    def rows(accounts: tuple[Account, ...] | list[Account]) -> tuple[LedgerRow, ...]:
        return tuple(
            row(each.label, amount(each), each.meaning)
            for each in accounts
            if each.column in history and amount(each) != 0.0
        )

    return Ledger(rows(income), rows(outgo), row("Left over", left, "came in less went out"), rows(told))
