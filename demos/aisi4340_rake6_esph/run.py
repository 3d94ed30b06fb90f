"""Cuts the block of demos/aisi4340_rake6 (AISI 4340, rake 6) with Eulerian SPH instead of the PFEM.

    python demos/aisi4340_rake6_esph/run.py [-o DIR] [--resume | --overwrite] [--travel MM]

The run goes to ``out``, small copies of its results to ``results`` beside this file.
"""

from pathlib import Path

from pfemcut.validation.demo import main

if __name__ == "__main__":
    main(Path(__file__).resolve().parent)
