"""The report of a session: the runs of an LCM log on one page, for a clinician."""
