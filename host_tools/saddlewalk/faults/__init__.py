"""Fault injection: scenarios, campaigns, and the definition of unsafe output."""
