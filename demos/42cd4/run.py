"""Cuts the case of the paper's section 7.5 (42CD4) and compares it with what the paper states.

    python demos/42cd4/run.py [-o DIR] [--resume | --overwrite] [--travel MM]
    OMP_NUM_THREADS=1 mpirun -n N python demos/42cd4/run.py

The run goes to ``out``, small copies of its results and the comparison to ``results`` beside this file.
"""

from pathlib import Path

from pfemcut.validation.demo import main

if __name__ == "__main__":
    main(Path(__file__).resolve().parent)
