"""What the core is compared with: its equations in other languages, and other walking planners."""


class MissingError(Exception):
    """A planner that is not installed, or finds no plan; the text gives the reason."""
