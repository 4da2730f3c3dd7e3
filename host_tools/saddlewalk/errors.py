"""The error for the user of a command."""


class UserError(Exception):
    """One line that names the object, the value and what is accepted. Exit status 2."""
