"""Refines the Taylor bar of total-Lagrangian SPH: final length and mushroom diameter against the spacing of particles.

    python demos/taylor_tlsph/ladder.py [-o DIR] [--resume | --overwrite] [--only NAME] [--conclude]

Spacings 0.63, 0.5, 0.4 and 0.33 mm, each with corrected and with plain kernel gradients; 0.5 mm also with the melting
temperature that the paper prints. Writes results/ladder.csv, ladder.json and pictures.
"""

from pathlib import Path

from pfemcut.validation.study import main
from pfemcut.validation.taylor import ladder

if __name__ == "__main__":
    main(ladder(Path(__file__).resolve().parent, "tlsph"))
