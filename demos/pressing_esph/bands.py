"""Shear bands of a pressed block against the spacing of particles, Eulerian SPH.

    python demos/pressing_esph/bands.py [-o DIR] [--resume | --overwrite] [--only NAME] [--conclude]

Spacings 0.02, 0.0133, 0.01 and 0.00667 mm (the last about 170 000 particles), with the melting temperature that the
paper prints. Concludes from the runs that are finished: results/bands.csv, bands.json and pictures.
"""

from pathlib import Path

from pfemcut.validation.pressing import pressings
from pfemcut.validation.study import main

if __name__ == "__main__":
    main(pressings(Path(__file__).resolve().parent, "esph"))
