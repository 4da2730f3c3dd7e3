"""What the core is measured beside: its equations elsewhere, and what people plan walks with."""


class MissingError(Exception):
    """A planner that is not installed, or finds no plan; the text gives the reason."""
