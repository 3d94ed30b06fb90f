"""Runs the Taylor bar at the paper's spacing and compares it with the experiment.

    python demos/taylor_esph/run.py [-o DIR] [--resume | --overwrite]

The run goes to ``out``, small copies of its results and the comparison to ``results`` beside this file.
"""

from pathlib import Path

from pfemcut.validation.demo import main

if __name__ == "__main__":
    main(Path(__file__).resolve().parent)
