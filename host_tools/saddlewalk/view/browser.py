"""The user's browser."""

import os
import sys
import webbrowser


def open_page(url: str) -> None:
    """Open a URL where a browser can show it: not in a terminal without a screen."""
    screen = any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER"))
    if screen or sys.platform == "darwin":
        webbrowser.open(url)
