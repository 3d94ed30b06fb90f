"""The report of a run: one HTML page with everything in it, made from the output directory alone."""

from pfemcut.output.report.page import write_report

__all__ = ["write_report"]
