"""What a fit found: fields of saddle_config_t, from how many steps, how well."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Fit:
    """One quantity: its fields, or why there are none."""

    quantity: str
    fields: dict[str, float] = field(default_factory=dict)
    steps: int = 0
    r2: float = np.nan  # share of the variance that is explained
    note: str = ""


def fields_of(fits: Sequence[Fit]) -> dict[str, float]:
    return {name: value for fit in fits for name, value in fit.fields.items()}


def r_squared(left_over: np.ndarray, values: np.ndarray) -> float:
    """NaN if the values are all the same."""
    about_mean = values - values.mean()
    return (
        float(1 - left_over @ left_over / (about_mean @ about_mean)) if about_mean.any() else np.nan
    )
