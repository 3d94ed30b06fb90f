"""Lets the tool go out of AISI 4340 through a free end, and measures the burr.

    python demos/aisi4340_exit/run.py [-o DIR] [--resume | --overwrite] [--travel MM]

The run goes to ``out``, small copies of its results to ``results`` beside this file.
"""

from pathlib import Path

from pfemcut.validation.surface import main

if __name__ == "__main__":
    main(Path(__file__).resolve().parent)
