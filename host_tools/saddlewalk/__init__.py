"""Host tools of Saddlewalk: offline commands, wearer emulator, replay, monitor and demo."""

from importlib.metadata import version

__version__ = version("saddlewalk")
