"""Runs of the published cases and of studies, recorded as small files beside each demo (``make validate``)."""
