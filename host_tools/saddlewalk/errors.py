"""The one error that is meant for the person who typed the command."""


class UserError(Exception):
    """Names the thing, the value, and what would be right, in one line. Exit status 2."""
