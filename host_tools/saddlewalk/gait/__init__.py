"""Recorded walks: reading them, measuring them, and fitting the model to a person."""
