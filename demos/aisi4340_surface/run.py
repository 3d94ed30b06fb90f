"""Cuts AISI 4340, unloads and cools it, and measures what is left below the machined surface.

    python demos/aisi4340_surface/run.py [-o DIR] [--resume | --overwrite] [--travel MM]

The run goes to ``out``, small copies of its results to ``results`` beside this file.
"""

from pathlib import Path

from pfemcut.validation.surface import main

if __name__ == "__main__":
    main(Path(__file__).resolve().parent)
