"""JSON as commands write it."""

import json
import math
from typing import Any


def json_text(value: Any) -> str:
    """Indented, one line at the end; unknown numbers are null."""
    return json.dumps(_without_nan(value), indent=1) + "\n"


def _without_nan(value: Any) -> Any:
    """Unknown numbers are null: JSON has no NaN."""
    if isinstance(value, dict):
        return {key: _without_nan(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_without_nan(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
