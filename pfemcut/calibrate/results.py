"""What a calibration found, as table and files."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from pfemcut.calibrate.confidence import LEVEL
from pfemcut.calibrate.cuts import target_names
from pfemcut.calibrate.study import JSON, TABLE, Calibration, Found
from pfemcut.output.tables import or_empty, print_table, write_csv
from pfemcut.sweep.units import units_of
from pfemcut.validation.provenance import provenance
from pfemcut.validation.recorded_run import sessions
from pfemcut.whole_files import finite, write_json


def write_found(study: Calibration, found: Found) -> None:
    """Write ``calibration.csv`` (the parameters) and ``calibration.json`` (all of it)."""
    keys = [each.key for each in study.parameters]
    known = found.confidence
    header = ["parameter", "value", "std", "low_95", "high_95", "start", "lower_bound", "upper_bound"]
    rows = [
        [
            each.parameter.key,
            each.value,
            *(or_empty(number) for number in (each.deviation, each.low, each.high)),
            each.parameter.start,
            each.parameter.low,
            each.parameter.high,
        ]
        for each in known.estimates
    ]
    write_csv(study.output / TABLE, header, rows)
    write_json(
        study.output / JSON,
        {
            "parameters": [
                {
                    "key": each.parameter.key,
                    "value": each.value,
                    "std": finite(each.deviation),
                    "interval": [finite(each.low), finite(each.high)],
                    "bounds": [each.parameter.low, each.parameter.high],
                    "start": each.parameter.start,
                }
                for each in known.estimates
            ],
            "level": LEVEL,
            "intervals_from": known.basis,
            "correlation": {
                one: {other: finite(float(known.correlation[i, j])) for j, other in enumerate(keys)}
                for i, one in enumerate(keys)
            },
            "condition": finite(known.condition),
            "misfit": known.misfit,
            "degrees_of_freedom": known.freedom,
            "plausibility": finite(known.plausibility),
            "converged": found.fit.converged,
            "ending": found.fit.ending,
            "points": found.points,
            "steps": found.fit.steps,
            "figures": _figures(study, found),
            "jacobian": found.fit.jacobian.tolist(),
            "controls": vars(study.controls),
            "uncertainties_assumed": study.assumed,
            "for_all": dict(study.common),
            "warnings": list(found.warnings),
            "runs": [
                {
                    "name": each.variant.name,
                    "steady": each.steady,
                    "warnings": each.summary["warnings"],
                    "sessions": sessions(each.variant.directory),
                }
                for each in found.runs
            ],
            "recorded": provenance(),
        },
    )


def print_found(study: Calibration, found: Found) -> None:
    """Print parameters, correlations, and measured figures beside the fitted ones."""
    known = found.confidence
    units = (
        units_of(found.runs[0].variant.case, [each.key for each in study.parameters]) if found.runs else {}
    )
    rows = [
        [
            each.parameter.key,
            units.get(each.parameter.key, ""),
            f"{each.value:.4g}",
            _text(each.deviation, "not determined", ".2g"),
            f"{each.low:.4g} to {each.high:.4g}" if math.isfinite(each.deviation) else "–",
            f"{each.parameter.low:g} to {each.parameter.high:g}",
            f"{each.parameter.start:g}",
        ]
        for each in known.estimates
    ]
    header = ["parameter", "unit", "fitted", "std", f"{LEVEL:.0%} interval", "bounds", "start"]
    print_table(f"{study.output}: {found.points} points, {found.fit.ending}", header, rows, texts=2)
    if len(rows) > 1:
        keys = [each.parameter.key for each in known.estimates]
        texts = [[_text(float(value), "–", "+.2f") for value in row] for row in known.correlation]
        print_table(
            f"correlation (condition {known.condition:.3g})",
            ["", *keys],
            [[key, *row] for key, row in zip(keys, texts, strict=True)],
            texts=1,
        )
    print_table(
        "measured and fitted",
        ["figure", "unit", "measured", "fitted", "difference", "in std"],
        [
            [
                each["name"],
                "" if each["unit"] == "-" else each["unit"],
                f"{each['measured']:.4g} ± {each['uncertainty']:.2g}",
                f"{each['fitted']:.4g}" + (f" ± {each['std']:.1g}" if each["std"] is not None else ""),
                f"{each['fitted'] / each['measured'] - 1.0:+.1%}" if each["measured"] else "–",
                f"{each['residual']:+.2f}",
            ]
            for each in _figures(study, found)
        ],
        texts=2,
    )
    print(f"intervals from {known.basis}", flush=True)


def _figures(study: Calibration, found: Found) -> Sequence[dict[str, Any]]:
    computed = found.fit.computed
    return [
        {
            "name": name,
            "unit": target.figure.unit,
            "cut": dict(study.cuts[target.cut]),
            "measured": target.figure.value,
            "uncertainty": target.figure.uncertainty,
            "source": target.figure.source,
            "fitted": float(value),
            "std": finite(float(deviation)),
            "residual": float(value - target.figure.value) / target.figure.uncertainty,
        }
        for name, target, value, deviation in zip(
            target_names(study.targets, study.cuts),
            study.targets,
            computed.values,
            computed.deviations,
            strict=True,
        )
    ]


def _text(value: float, otherwise: str, form: str) -> str:
    return format(value, form) if math.isfinite(value) else otherwise
