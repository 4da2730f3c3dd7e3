"""Planned walks without a wearer, steady or by a schedule."""
