"""Logs of a walk: written, read, tabulated and computed again."""
