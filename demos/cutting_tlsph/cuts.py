"""Cuts at feeds of 0.3 and 0.5 mm with total-Lagrangian SPH: forces, chip, bands, segments and the particles' disorder.

    python demos/cutting_tlsph/cuts.py [-o DIR] [--resume | --overwrite] [--only NAME] [--conclude]

Spacings 0.02 mm and 0.01 mm, the paper's.
The melting temperature is the one that the paper prints, 1573 K; one run has that of the literature.
Concludes from the runs that are finished: results/cuts.csv, cuts.json and pictures.
"""

from pathlib import Path

from pfemcut.validation.particle_cuts import cuts
from pfemcut.validation.study import main

if __name__ == "__main__":
    main(cuts(Path(__file__).resolve().parent, "tlsph"))
