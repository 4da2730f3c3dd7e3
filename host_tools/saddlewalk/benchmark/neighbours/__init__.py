"""What the core is measured beside: its equations elsewhere, and what people plan walks with."""


class MissingError(Exception):
    """A neighbour that is not here, or that finds no plan; the text says why."""
