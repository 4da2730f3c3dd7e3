"""States from which a pendulum with feet can come to rest, against the core's claims.

The linear pendulum about a CoP that may be anywhere in the soles that stand comes to rest if the
CoP goes beyond the XCoM, away from the middle of the soles, as far as they reach: the XCoM then
returns straight to the middle. No controller does better, because an XCoM outside the soles departs
wherever the CoP is. Beside that stands the same with bounded ankle work: what the CoP's distance
from the line between the standing CoPs does on the moving CoM must not exceed W_max.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from saddlewalk.core import body_of, ffi, library, model_of
from saddlewalk.emulation.wearer import Body
from saddlewalk.evaluation.baselines import hull_corners_m

TIME_STEP_S, DURATION_S = 0.02, 3.0
GAIN_MAX = 4.0  # limit of the CoP's distance beyond the XCoM, for the work of an unhurried stop
GRID = 9  # states along each of x, y, vx, vy
EXTENT = np.array([0.5, 0.3, 1.2, 0.8])  # m, m, m/s, m/s to either side

CLAIMS = {
    "bos": "CoM in BoS",
    "can_stop": "can_stop",
    "stays": "can_stop, XCoM in BoS",  # as in the supervisor: by stop_margin_m
}


@dataclass(frozen=True)
class Posture:
    name: str
    cop_m: tuple[tuple[float, float], tuple[float, float]]  # left, right
    stands: tuple[bool, bool] = (True, True)

    @property
    def standing_m(self) -> np.ndarray:
        """(1 or 2, 2): the CoPs of the feet that stand."""
        pairs = zip(self.cop_m, self.stands, strict=True)
        return np.array([cop for cop, is_down in pairs if is_down])


POSTURES = (
    Posture("side by side", ((0.0, 0.11), (0.0, -0.11))),
    Posture("double support", ((0.35, 0.05), (-0.35, -0.05))),
    Posture("mid-step, right foot", ((0.0, 0.05), (0.0, -0.05)), (False, True)),
)


@dataclass(frozen=True)
class Region:
    """The results of a posture, for (n, 4) states x, y, vx, vy, from midway between the CoPs."""

    posture: Posture
    states: np.ndarray
    stops: np.ndarray  # the pendulum can be brought to rest
    stops_within_work: np.ndarray  # and with bounded ankle work
    claims: dict[str, np.ndarray]  # by the keys of CLAIMS

    def confusion(self, claim: str) -> dict[str, int]:
        """Counts of states by claim and truth; `false_safe` contradicts the paper.

        `false_safe_by_work`: the false_safe states that stop with more ankle work than W_max.
        """
        claimed, truth = self.claims[claim], self.stops_within_work
        strained = self.stops & ~truth
        return {
            "true_safe": int((claimed & truth).sum()),
            "false_safe": int((claimed & ~truth).sum()),
            "false_safe_by_work": int((claimed & strained).sum()),
            "false_unsafe": int((~claimed & truth).sum()),
            "true_unsafe": int((~claimed & ~truth).sum()),
        }


def grid() -> np.ndarray:
    axes = [np.linspace(-extent, extent, GRID) for extent in EXTENT]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 4)


def plane(posture: Posture, first: int, second: int, points: int) -> np.ndarray:
    """(points * points, 4) states over two of x, y, vx, vy.

    Along the others at rest in the middle of the feet that stand.
    """
    states = np.zeros((points * points, 4))
    states[:, :2] = posture.standing_m.mean(axis=0)
    axes = [np.linspace(-EXTENT[k], EXTENT[k], points) for k in (first, second)]
    mesh = np.meshgrid(*axes, indexing="ij")
    states[:, first], states[:, second] = mesh[0].ravel(), mesh[1].ravel()
    return states


def explore(posture: Posture, states: np.ndarray, config: Any) -> Region:
    stops, work_j = bring_to_rest(posture, states, Body.of(config))
    claims = _claims(posture, states, config)
    return Region(posture, states, stops, stops & (work_j <= _work_max_j(config)), claims)


def bring_to_rest(
    posture: Posture, states: np.ndarray, body: Body
) -> tuple[np.ndarray, np.ndarray]:
    """Whether each state comes to rest, and the work that the ankles absorb until then.

    A state whose XCoM is inside the soles after DURATION_S is at rest or will be; outside them it
    diverges.
    """
    w = body.natural_frequency_rad_s
    standing = posture.standing_m
    soles = _soles(standing, body)
    middle = standing.mean(axis=0)
    com, velocity = states[:, :2].copy(), states[:, 2:].copy()
    work_j = np.zeros(len(states))
    cosh, sinh = math.cosh(w * TIME_STEP_S), math.sinh(w * TIME_STEP_S)
    for _ in range(round(DURATION_S / TIME_STEP_S)):
        xcom = com + velocity / w
        cop = xcom + (xcom - middle) * _reach(soles, xcom, xcom - middle)[:, None]
        lever = cop - _nearest_on(standing, cop)
        power_w = body.mass_kg * w**2 * (lever * velocity).sum(axis=1)
        work_j += np.maximum(power_w, 0.0) * TIME_STEP_S
        arm = com - cop
        com, velocity = cop + arm * cosh + velocity * (sinh / w), arm * w * sinh + velocity * cosh
    xcom = com + velocity / w
    return _reach(soles, xcom, xcom - middle) >= 0, work_j


def _soles(standing: np.ndarray, body: Body) -> np.ndarray:
    """Corners of the hull of the soles that stand, counter-clockwise."""
    half = np.array([body.foot_half_length_m, body.foot_half_width_m])
    apart = standing[-1] - standing[0]
    return standing[0] + hull_corners_m(apart[None, :], half)[0]


def _reach(soles: np.ndarray, point: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """How far each point can move along direction within the soles, up to GAIN_MAX; negative if
    outside.
    """
    edge = np.roll(soles, -1, axis=0) - soles
    inward = np.stack([-edge[:, 1], edge[:, 0]], axis=1)
    depth = (inward * (point[:, None, :] - soles)).sum(axis=2)
    outgoing = -(inward * direction[:, None, :]).sum(axis=2)
    share = np.where(outgoing > 1e-12, depth / np.where(outgoing > 1e-12, outgoing, 1.0), np.inf)
    return np.clip(share.min(axis=1), -1.0, GAIN_MAX)


def _nearest_on(standing: np.ndarray, point: np.ndarray) -> np.ndarray:
    """The nearest point on the line between the standing CoPs, along which load shifts."""
    apart = standing[-1] - standing[0]
    squared = float(apart @ apart)
    along = (
        np.clip((point - standing[0]) @ apart / squared, 0.0, 1.0) if squared else 0 * point[:, 0]
    )
    return standing[0] + along[:, None] * apart


def _work_max_j(config: Any) -> float:
    return body_of(config).ankle_work_j


def _claims(posture: Posture, states: np.ndarray, config: Any) -> dict[str, np.ndarray]:
    core = library()
    model, seen = model_of(config), ffi().new("saddle_posture_t *")
    scores, support = ffi().new("saddle_scores_t *"), ffi().new("saddle_support_t *")
    seen.known = core.SADDLE_KNOWN_FEET | core.SADDLE_KNOWN_VELOCITY
    for cop, (x_m, y_m) in zip(seen.cop_m, posture.cop_m, strict=True):
        cop.x, cop.y = x_m, y_m
    claimed = {claim: np.zeros(len(states), dtype=bool) for claim in CLAIMS}
    for index, (x_m, y_m, vx_m_s, vy_m_s) in enumerate(states.tolist()):
        seen.com.com_m.x, seen.com.com_m.y = x_m, y_m
        seen.com.velocity_m_s.x, seen.com.velocity_m_s.y = vx_m_s, vy_m_s
        core.saddle_score_posture(model, seen, scores, support)
        claimed["bos"][index] = scores.mos_com_m >= 0
        claimed["can_stop"][index] = scores.can_stop
        claimed["stays"][index] = scores.can_stop and scores.mos_xcom_m >= config.stop_margin_m
    return claimed
