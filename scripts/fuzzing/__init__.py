"""Mutated inputs and damaged folders for everything that reads what users give; see ``scripts/fuzz_inputs.py``."""
