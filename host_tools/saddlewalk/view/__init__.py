"""A walk in the browser, live from LCM or from a log."""
