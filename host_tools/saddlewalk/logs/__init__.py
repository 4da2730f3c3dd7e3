"""Logs of a walk: writing, reading, exporting and recomputing them."""
