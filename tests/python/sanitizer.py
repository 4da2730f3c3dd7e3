"""Whether the address sanitizer runs: it multiplies memory and lets mlockall() do nothing."""

import os

SANITIZED = "libasan" in os.environ.get("LD_PRELOAD", "")
WITHOUT = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
