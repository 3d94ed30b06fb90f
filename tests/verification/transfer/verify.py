"""What hundreds of remeshes cost a field by each transfer rule, on three meshes.

    python -m tests.verification.transfer.verify

takes about four minutes. There is no case file: the particles follow a known motion, nothing is solved.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt

from ..common import save_picture, write_results, write_table
from .study import FLOWS, RULES_BY_NAME, advected

FOLDER = Path(__file__).parent

SIZES = (0.14, 0.1, 0.07, 0.05)
STEPS = (100, 200, 400)


def ladder() -> list[dict]:
    """Rows of all rules by spacing at 200 remeshes, and by number of remeshes at the spacing of 0.07."""
    rows = []
    for name, flow in FLOWS.items():
        for size, steps in [
            *((size, 200) for size in SIZES),
            *((0.07, steps) for steps in STEPS if steps != 200),
        ]:
            found = advected(flow(), tuple(RULES_BY_NAME), size, steps)
            particles = found.pop("particles")
            found.pop("conserved")
            for rule, errors in found.items():
                row = {"flow": name, "h": size, "remeshes": steps, "rule": rule, **errors}
                row |= {f"particle_{key}": particles[key] for key in ("heat_jump", "heat_error", "l2_error")}
                rows.append(
                    {**row, "changed_elements": particles["changed"], "elements": particles["elements"]}
                )
                print(rows[-1], flush=True)
    return rows


def particle_rows() -> list[dict]:
    """Rows of the particle field as it is carried, and with its integral restored after each of 200 remeshes."""
    rows = []
    for name, flow in FLOWS.items():
        for size in SIZES:
            for rule, errors in advected(flow(), (), size, 200).items():
                rows.append({"flow": name, "h": size, "remeshes": 200, "rule": rule, **errors})
                print(rows[-1], flush=True)
    return rows


def draw(rows: list[dict]) -> None:
    """Accumulated error against spacing."""
    figure, axes = plt.subplots(1, 3, figsize=(11, 3.6), layout="constrained")
    styles = dict(zip(RULES_BY_NAME, ("C3o-", "C1s-", "C2^-", "C0D-"), strict=True))
    for axis, (flow, column, title) in zip(
        axes,
        (
            ("swirl", "l2_error", "swirl: L2 error after 200 remeshes"),
            ("shear", "l2_error", "shear and back: L2 error after 200 remeshes"),
            ("swirl", "integral_error", "swirl: error of the integral"),
        ),
        strict=True,
    ):
        for rule, style in styles.items():
            found = [row for row in rows if (row["flow"], row["rule"], row["remeshes"]) == (flow, rule, 200)]
            axis.loglog([row["h"] for row in found], [row[column] for row in found], style, label=rule)
        axis.set(title=title, xlabel="spacing h (radius or half side 1)", xticks=SIZES, xticklabels=SIZES)
        axis.minorticks_off()
        axis.title.set_fontsize(10)
    axes[0].legend(fontsize=8)
    save_picture(FOLDER, figure)


def main() -> None:
    write_table(FOLDER / "results" / "particles.csv", particle_rows())
    rows = ladder()
    write_results(
        FOLDER,
        rows,
        {
            f"{row['flow']}, {row['rule']}": {
                key: row[key] for key in ("integral_jump", "integral_error", "l2_jump", "l2_error", "ms")
            }
            for row in rows
            if (row["h"], row["remeshes"]) == (0.05, 200)
        },
    )
    draw(rows)


if __name__ == "__main__":
    main()
