"""What a fit found: fields of saddle_config_t, from how many steps, how well."""

from collections.abc import Callable, Sequence
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


STEEPEST = 1e8  # of the damping: no step is shorter
SMALLEST = 1e-6  # change of the coefficients that is worth another step


def least_squares(
    residuals: Callable[[np.ndarray], np.ndarray],
    start: np.ndarray,
    bounds: tuple[Sequence[float], Sequence[float]],
) -> np.ndarray:
    """Coefficients of the smallest sum of squares near `start`, by Levenberg and Marquardt."""
    found, damping = np.asarray(start, dtype=float), 1e-3
    rest = residuals(found)
    while damping < STEEPEST:
        slopes = [
            (residuals(found + step) - rest) / SMALLEST for step in SMALLEST * np.eye(len(found))
        ]
        jacobian = np.stack(slopes, axis=1)
        square = jacobian.T @ jacobian
        step = np.linalg.solve(square + damping * np.diag(np.diag(square)), -jacobian.T @ rest)
        tried = np.clip(found + step, *bounds)
        tried_rest = residuals(tried)
        if tried_rest @ tried_rest < rest @ rest:
            moved = np.abs(tried - found).max()
            found, rest, damping = tried, tried_rest, damping / 10
            if moved < SMALLEST:
                break
        else:
            damping *= 10
    return found
