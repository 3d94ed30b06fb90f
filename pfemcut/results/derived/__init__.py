"""Derived figures of a cut: one quantity a module, each a pure function of the arrays of a frame."""
