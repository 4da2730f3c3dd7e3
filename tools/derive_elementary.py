#!/usr/bin/env python3
"""Derive the polynomial coefficients and split constants of firmware/core/src/math/elementary.c.

Each polynomial is the weighted minimax fit of the exact function (mpmath, 50 digits), found by the
Remez exchange on a dense Chebyshev grid, then rounded to single precision. The weight turns the
error of the polynomial into the error of the finished function: relative for sin, asin, exp - 1 and
erf, absolute for cos. The printed block stands unchanged in the source.

Needs mpmath. Run: python tools/derive_elementary.py
"""

import struct
from collections.abc import Callable
from dataclasses import dataclass

from mpmath import mp, mpf

Function = Callable[[mpf], mpf]

GRID_POINTS = 2000
MAX_EXCHANGES = 50
CONVERGED = mpf("1e-3")


@dataclass(frozen=True)
class Fit:
    """A polynomial p(t) near `target` on (low, high); weight * (p - target) is its error."""

    name: str
    meaning: str
    target: Function
    weight: Function
    low: mpf
    high: mpf
    degree: int


def chebyshev_points(low: mpf, high: mpf, count: int) -> list[mpf]:
    """Chebyshev points of the first kind, ascending; the ends are not among them."""
    centre, half = (low + high) / 2, (high - low) / 2
    return [centre - half * mp.cos(mp.pi * (2 * i + 1) / (2 * count)) for i in range(count)]


def evaluate(coefficients: list[mpf], t: mpf) -> mpf:
    return mp.polyval(coefficients[::-1], t)


def alternating_extrema(errors: list[mpf]) -> list[int]:
    """Index of the largest error in each run of errors of one sign."""
    extrema = [0]
    for i in range(1, len(errors)):
        if errors[i] * errors[extrema[-1]] < 0:
            extrema.append(i)
        elif abs(errors[i]) > abs(errors[extrema[-1]]):
            extrema[-1] = i
    return extrema


def level_polynomial(points: list[mpf], targets: list[mpf], weights: list[mpf]) -> list[mpf]:
    """The polynomial whose weighted error has one size and alternating sign at the points."""
    size = len(points)
    matrix = mp.matrix(size, size)
    for row, (t, weight) in enumerate(zip(points, weights, strict=True)):
        for power in range(size - 1):
            matrix[row, power] = t**power
        matrix[row, size - 1] = (-1) ** row / weight
    return list(mp.lu_solve(matrix, mp.matrix(targets)))[:-1]


def minimax(fit: Fit) -> list[mpf]:
    """Remez exchange; coefficients in ascending powers."""
    grid = chebyshev_points(fit.low, fit.high, GRID_POINTS)
    targets = [fit.target(t) for t in grid]
    weights = [fit.weight(t) for t in grid]
    count = fit.degree + 2
    chosen = [round((i + 0.5) * GRID_POINTS / count) for i in range(count)]
    for _ in range(MAX_EXCHANGES):
        coefficients = level_polynomial(
            [grid[i] for i in chosen], [targets[i] for i in chosen], [weights[i] for i in chosen]
        )
        errors = [
            w * (evaluate(coefficients, t) - y)
            for t, y, w in zip(grid, targets, weights, strict=True)
        ]
        extrema = alternating_extrema(errors)
        while len(extrema) > count:
            extrema.pop(0 if abs(errors[extrema[0]]) < abs(errors[extrema[-1]]) else -1)
        sizes = [abs(errors[i]) for i in extrema]
        if len(extrema) == count and max(sizes) - min(sizes) < CONVERGED * max(sizes):
            return coefficients
        if len(extrema) < count:
            raise ArithmeticError(f"{fit.name}: {len(extrema)} extrema, {count} are needed")
        chosen = extrema
    raise ArithmeticError(f"{fit.name}: no convergence in {MAX_EXCHANGES} exchanges")


def to_single(value: mpf) -> mpf:
    return mpf(struct.unpack("f", struct.pack("f", float(value)))[0])


def truncate(value: mpf, bits: int) -> mpf:
    """The leading `bits` bits of a positive value, so that small integers times it are exact."""
    scale = mpf(2) ** (bits - 1 - mp.floor(mp.log(value, 2)))
    return mp.floor(value * scale) / scale


def literal(value: mpf) -> str:
    return f"{float(to_single(value)):.8e}f"


def largest_error(fit: Fit, coefficients: list[mpf]) -> float:
    """Weighted, on the grid of the fit."""
    grid = chebyshev_points(fit.low, fit.high, GRID_POINTS)
    return float(
        max(abs(fit.weight(t) * (evaluate(coefficients, t) - fit.target(t))) for t in grid)
    )


def fits() -> list[Fit]:
    quarter = mp.pi / 4
    half_ln2 = mp.log(2) / 2

    return [
        Fit(
            "SIN",
            "sin r = r + r z S(z), z = r^2, |r| <= pi/4; relative",
            lambda z: (mp.sin(mp.sqrt(z)) / mp.sqrt(z) - 1) / z,
            lambda z: z * mp.sqrt(z) / mp.sin(mp.sqrt(z)),
            mpf(0),
            quarter**2,
            2,
        ),
        Fit(
            "COS",
            "cos r = 1 - z/2 + z^2 C(z), z = r^2, |r| <= pi/4; absolute",
            lambda z: (mp.cos(mp.sqrt(z)) - 1 + z / 2) / z**2,
            lambda z: z**2,
            mpf(0),
            quarter**2,
            2,
        ),
        Fit(
            "ASIN",
            "asin s = s + s z A(z), z = s^2, 0 <= s <= 1/2; relative",
            lambda z: (mp.asin(mp.sqrt(z)) / mp.sqrt(z) - 1) / z,
            lambda z: z * mp.sqrt(z) / mp.asin(mp.sqrt(z)),
            mpf(0),
            mpf(1) / 4,
            4,
        ),
        Fit(
            "EXPM1",
            "exp r - 1 = r + r^2 E(r), |r| <= ln(2)/2; relative",
            lambda r: (mp.expm1(r) - r) / r**2,
            lambda r: r**2 / abs(mp.expm1(r)),
            -half_ln2,
            half_ln2,
            4,
        ),
        Fit(
            "ERF",
            "erf a = 1 - exp(a Q(a)), 0 <= a <= 4; relative",
            lambda a: mp.log(mp.erfc(a)) / a,
            lambda a: a * mp.erfc(a) / mp.erf(a),
            mpf(0),
            mpf(4),
            7,
        ),
    ]


def print_polynomial(fit: Fit) -> None:
    coefficients = [to_single(c) for c in minimax(fit)]
    print(f"/* {fit.meaning}: {largest_error(fit, coefficients):.1e} */")
    print(f"static const float {fit.name}[] = {{")
    for i in range(0, len(coefficients), 4):
        print("    " + ", ".join(literal(c) for c in coefficients[i : i + 4]) + ",")
    print("};")


def print_split(name: str, value: mpf, bits: int) -> None:
    high = truncate(value, bits)
    print(f"static const float {name}_HI = {literal(high)};")
    print(f"static const float {name}_LO = {literal(value - high)};")


def main() -> None:
    mp.dps = 50
    print(f"static const float TWO_OVER_PI = {literal(2 / mp.pi)};")
    print_split("HALF_PI", mp.pi / 2, 21)
    print(f"static const float LOG2_E = {literal(1 / mp.log(2))};")
    print_split("LN2", mp.log(2), 16)
    for fit in fits():
        print()
        print_polynomial(fit)


if __name__ == "__main__":
    main()
