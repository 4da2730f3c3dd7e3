"""Logs of a walk: written, read, tabulated and recomputed."""
