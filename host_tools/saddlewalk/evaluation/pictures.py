"""Pictures of an evaluation: ROC curves of both kinds of wearer, and the region of attraction."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from saddlewalk.evaluation.cross_validation import CrossValidation
from saddlewalk.evaluation.detection import evidence
from saddlewalk.evaluation.region import CLAIMS, EXTENT, POSTURES, explore, plane
from saddlewalk.evaluation.scoring import roc
from saddlewalk.evaluation.walks import KINDS, MARGINS, WINDOWS, Walk
from saddlewalk.pictures.walk import BLUE, GREEN, ORANGE, PINK, RED, SKY

matplotlib.use("Agg")

COLOURS = (BLUE, SKY, GREEN, ORANGE, RED, PINK, "black", "0.5")
DASHES = ("-", "--", ":")
AXES = ("x (m), forward", "y (m), to the left", "x velocity (m/s)", "y velocity (m/s)")
PLANES = ((0, 2), (1, 3))
POINTS = 81
VERDICTS = (
    ("true unsafe", "0.93"),
    ("false unsafe: can stop", SKY),
    ("false safe: cannot stop", RED),
    ("true safe", GREEN),
)


def draw_rocs(walks: Sequence[Walk], path: Path) -> None:
    """ROC curves for each kind of wearer: evidence to WARNING_MIN_S before a fall, and of the first
    SOON_S.
    """
    windows = WINDOWS[1:]
    figure = Figure(figsize=(13, 13.5), dpi=110, layout="constrained")
    panels = figure.subplots(len(KINDS), len(windows))
    for row, kind in zip(panels, KINDS, strict=True):
        of_kind = [walk for walk in walks if walk.trial.kind == kind and walk.trial.impulse_n_s > 0]
        for axes, window in zip(row, windows, strict=True):
            for index, name in enumerate(MARGINS):
                false, true = roc(*evidence(of_kind, window, name))
                style = {"color": COLOURS[index % 8], "ls": DASHES[index // 8]}
                axes.plot(np.append(false, 1.0), np.append(true, 1.0), label=name, **style)
            axes.plot([0, 1], [0, 1], color="0.8", lw=0.8)
            axes.set(
                title=f"takes {kind} steps; evidence: {window}",
                xlabel="alarms in walks without a fall",
                ylabel="falls predicted",
                aspect="equal",
            )
    handles, labels = panels[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize=12)
    figure.savefig(path)


def draw_reliability(found: Mapping[str, CrossValidation], path: Path) -> None:
    """Observed over predicted falls: each walker with the fit to the others."""
    figure = Figure(figsize=(6, 6), dpi=110, layout="constrained")
    axes = figure.subplots()
    axes.plot([0, 1], [0, 1], color="0.8", lw=0.8)
    for index, (name, each) in enumerate(found.items()):
        predicted, observed, ticks = zip(*each.reliability, strict=True)
        axes.plot(predicted, observed, "-", color=COLOURS[index % 8], lw=0.8)
        sizes = 8 * np.log2(np.array(ticks))
        axes.scatter(
            predicted, observed, s=sizes, color=COLOURS[index % 8], label=name.replace("_", " ")
        )
    axes.set(
        title="Falls within a second, predicted by the fit to the other walkers",
        xlabel="predicted from the margin",
        ylabel="observed",
        aspect="equal",
    )
    axes.legend(loc="lower right")
    figure.savefig(path)


def draw_region(config: Any, path: Path) -> None:
    """can_stop, alone and with the XCoM, compared with the pendulum with bounded ankle work."""
    claims = ("can_stop", "stays")
    figure = Figure(figsize=(15, 13), dpi=100, layout="constrained")
    rows = figure.subplots(len(claims) * len(PLANES), len(POSTURES))
    for column, posture in enumerate(POSTURES):
        for pair, (first, second) in enumerate(PLANES):
            region = explore(posture, plane(posture, first, second, POINTS), config)
            for which, claim in enumerate(claims):
                axes = rows[len(PLANES) * which + pair, column]
                code = region.stops_within_work + 2 * region.claims[claim]
                axes.imshow(
                    code.reshape(POINTS, POINTS).T,
                    cmap=ListedColormap([colour for _, colour in VERDICTS]),
                    vmin=0,
                    vmax=len(VERDICTS) - 1,
                    origin="lower",
                    aspect="auto",
                    extent=(-EXTENT[first], EXTENT[first], -EXTENT[second], EXTENT[second]),
                )
                axes.set(xlabel=AXES[first], ylabel=AXES[second])
                axes.set_title(f"{posture.name}: {CLAIMS[claim]}", fontsize=9)
    patches = [Patch(color=colour, label=name) for name, colour in VERDICTS]
    figure.legend(handles=patches, loc="outside upper center", ncols=len(VERDICTS))
    figure.savefig(path)
