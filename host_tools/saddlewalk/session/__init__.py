"""A session: the runs of an LCM log as a clinician reads them, on one page."""
