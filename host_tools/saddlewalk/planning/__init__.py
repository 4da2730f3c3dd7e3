"""Walks as they are planned, steady or by a schedule, without a wearer."""
