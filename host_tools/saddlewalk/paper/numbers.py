"""The paper's numbers and findings, compared with the core's results."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal

from saddlewalk.config import DEFAULT_HEIGHT_M
from saddlewalk.core import body_of
from saddlewalk.paper.simulations import (
    FIGURE_HEEL_STRIKE_DEG,
    HEEL_STRIKES_DEG,
    SPEEDS_M_S,
    Gait,
    Walk,
    gait,
    mean_body,
    simulate,
)

PARAMETER_TOLERANCE = 1e-4  # relative: recovered from rows in single precision
ORENDURFF_M = {0.7: (0.0274, 0.0052), 1.6: (0.0483, 0.0092)}  # CoM height, mean and SD by speed
VARIABILITY_SD = 2.0  # standard deviations that count as human variability

# Worked by hand from the equations as docs/equations.md reads them; in the order of SPEEDS_M_S.
HALF_STEP_MM = ("261.24", "315.30", "351.34", "423.42")
HALF_STEP_MIN_MM = ("112.9", "161.3", "193.5", "258.0")
WIDTH_MM = ("196.64", "132.80", "100.00", "100.00")
HUMAN_VERTICAL_MM = ("21.167", "29.135", "34.447", "45.071")
S_SW_MIN = ("0.545", "0.682", "0.735", "0.801")
TOE_OFF_DEG = ("9.6", "12.3", "15.5", "25.1")
PLANNER_VERTICAL_MM = ("19.8", "33.1", "44.7", "73.6")
RIGID_VERTICAL_MM = ("37.5", "51.2", "63.0", "92.6")
JUMP_MM = ("0", "-5", "-11", "-29")


@dataclass(frozen=True)
class Number:
    """A number of the paper and the core's."""

    what: str
    case: str
    paper: str  # as printed
    ours: float
    unit: str
    tolerance: float
    source: str
    stated: bool  # in the paper; else worked from its equations as docs/equations.md reads them

    @property
    def difference(self) -> float:
        return self.ours - float(self.paper)

    @property
    def sound(self) -> bool:
        return abs(self.difference) <= self.tolerance


@dataclass(frozen=True)
class Finding:
    """A result that the paper states in words, and whether it holds here."""

    claim: str
    ours: str
    holds: bool


@dataclass(frozen=True)
class Simulations:
    """The paper's simulations, and the rigid pendulum at the same speeds."""

    walks: dict[tuple[float, float], Walk]  # by speed and heel-strike angle in degrees
    rigid: dict[float, Walk]
    gaits: dict[float, Gait]

    def at(self, speed_m_s: float) -> Walk:
        """The walk at the heel-strike angle of the paper's figures."""
        return self.walks[speed_m_s, FIGURE_HEEL_STRIKE_DEG]


def simulate_all() -> Simulations:
    return Simulations(
        walks={(v, angle): simulate(v, angle) for v in SPEEDS_M_S for angle in HEEL_STRIKES_DEG},
        rigid={v: simulate(v, ankle="rigid") for v in SPEEDS_M_S},
        gaits={v: gait(v) for v in SPEEDS_M_S},
    )


def numbers(simulations: Simulations) -> list[Number]:
    return [*_parameters(simulations), *_limits(), *_at_each_speed(simulations)]


def half_digit(printed: str) -> float:
    """Half a unit of the last printed digit."""
    return 0.5 * 10.0 ** int(Decimal(printed).as_tuple().exponent)


def _parameters(simulations: Simulations) -> Iterator[Number]:
    """The paper's constants, each recovered from planned walks."""
    slow, fast = simulations.at(SPEEDS_M_S[0]), simulations.at(SPEEDS_M_S[-1])
    middle = simulations.at(1.0)
    vertical = [(v, simulations.gaits[v].vertical_m) for v in (SPEEDS_M_S[0], SPEEDS_M_S[-1])]
    widths = [(walk.speed_m_s, walk.step_width_m) for walk in (slow, middle)]
    halves = [(walk.speed_m_s, walk.step_length_m / 2) for walk in (slow, fast)]
    rigid_leg_m = simulations.rigid[1.2]["leg_length_m"][0]
    cases = (
        ("step width, slow", "below 0.6 m/s", "0.22", gait(0.5).width_m, "m", "eq:03"),
        ("step width, fast", "above 1.1 m/s", "0.10", fast.step_width_m, "m", "eq:03"),
        ("step width, slope", "0.7 to 1.0 m/s", "-0.2128", _slope(*widths), "s", "eq:03"),
        ("step width, intercept", "0.7 to 1.0 m/s", "0.3456", _intercept(*widths), "m", "eq:03"),
        ("half step length, slope", "", "0.1802", _slope(*halves), "s", "eq:04"),
        ("half step length, intercept", "", "0.1351", _intercept(*halves), "m", "eq:04"),
        ("vertical amplitude, slope", "", "0.02656", _slope(*vertical), "s", "eq:07"),
        ("vertical amplitude, intercept", "", "0.002575", _intercept(*vertical), "m", "eq:07"),
        ("pendulum by body height", "", "0.57", rigid_leg_m / DEFAULT_HEIGHT_M, "", "eq:06"),
        ("CoP to the foot's pivots", "", "0.1", _pivot_m(simulations), "m", "eq:05"),
        ("time constant of the ankle", "", "0.11", fast.ankle_time_constant_s, "s", "eq:A1"),
        ("XCoM and reach limits meet", "“about”", "3", _meeting_m_s(), "m/s", "fig:05"),
    )
    for what, case, paper, ours, unit, source in cases:
        tolerance = PARAMETER_TOLERANCE * abs(float(paper))
        yield Number(what, case, paper, float(ours), unit, tolerance, source, stated=True)


def _limits() -> Iterator[Number]:
    body = body_of(mean_body())
    for what, paper, ours, unit, source in (
        ("pendulum length", "1.0203", body.pendulum_m, "m", "eq:06"),
        ("natural frequency", "3.1002", body.natural_frequency_rad_s, "rad/s", "eq:09"),
        ("reach of half a step", "0.4838", body.half_step_max_m, "m", "eq:09"),
        ("speed ceiling", "1.935", body.speed_ceiling_m_s, "m/s", "eq:09"),
    ):
        yield Number(what, "", paper, ours, unit, half_digit(paper), source, stated=False)


def _at_each_speed(simulations: Simulations) -> Iterator[Number]:
    for index, speed_m_s in enumerate(SPEEDS_M_S):
        walk, model = simulations.at(speed_m_s), simulations.gaits[speed_m_s]
        rigid_mm = 1e3 * simulations.rigid[speed_m_s].vertical_m
        toe_off_deg = math.degrees(walk.toe_off_rad)
        for what, papers, ours, unit, source, stated in (
            ("half step length", HALF_STEP_MM, 500 * walk.step_length_m, "mm", "eq:04", True),
            ("XCoM limit", HALF_STEP_MIN_MM, 1e3 * model.half_step_min_m, "mm", "eq:09", True),
            ("step width", WIDTH_MM, 1e3 * walk.step_width_m, "mm", "eq:03", True),
            ("vertical, people", HUMAN_VERTICAL_MM, 1e3 * model.vertical_m, "mm", "eq:07", True),
            (
                "vertical, planner",
                PLANNER_VERTICAL_MM,
                1e3 * walk.vertical_m,
                "mm",
                "fig:08",
                False,
            ),
            ("vertical, rigid", RIGID_VERTICAL_MM, rigid_mm, "mm", "fig:08", False),
            ("jump of z", JUMP_MM, 1e3 * walk.jump_m, "mm", "fig:09n", False),
            ("least S_SW", S_SW_MIN, walk.s_sw_min, "", "fig:07", False),
            ("toe-off angle", TOE_OFF_DEG, toe_off_deg, "°", "eq:08", False),
        ):
            paper = papers[index]
            case = f"{speed_m_s} m/s"
            yield Number(what, case, paper, float(ours), unit, half_digit(paper), source, stated)


def _pivot_m(simulations: Simulations) -> float:
    """d_h from the stance leg's elongation by the toe-off angle, eq:05, where it is largest."""
    walk, rigid = simulations.at(1.2), simulations.rigid[1.2]
    largest = int(walk["theta_to_rad"][walk["phase"] == 0].argmax())
    longer_m = walk["leg_length_m"][largest] - rigid["leg_length_m"][largest]
    return longer_m / (2 * math.sin(walk["theta_to_rad"][largest] / 2))


def _meeting_m_s() -> float:
    """The speed at which the XCoM limit, which is proportional to speed, is at the reach limit."""
    at_one = gait(1.0)
    return at_one.half_step_max_m / at_one.half_step_min_m


def _slope(a: tuple[float, float], b: tuple[float, float]) -> float:
    return (b[1] - a[1]) / (b[0] - a[0])


def _intercept(a: tuple[float, float], b: tuple[float, float]) -> float:
    return a[1] - _slope(a, b) * a[0]


def findings(simulations: Simulations) -> list[Finding]:
    return [
        _within_limits(simulations),
        _faster_than_the_pendulum(simulations),
        _on_the_saddle(simulations),
        _in_the_funnel(simulations),
        _stabler_when_faster(simulations),
        _better_than_rigid(simulations),
        _accurate_when_slow(simulations),
        _less_smooth_than_people(simulations),
    ]


def _within_limits(simulations: Simulations) -> Finding:
    gaits = simulations.gaits.values()
    return Finding(
        "The planned step lies between the XCoM limit and the reach (fig:05)",
        "half steps of " + _list([1e3 * g.half_step_m for g in gaits], "mm", 0),
        all(g.half_step_min_m < g.half_step_m < g.half_step_max_m for g in gaits),
    )


def _faster_than_the_pendulum(simulations: Simulations) -> Finding:
    cadence_hz = [1 / simulations.at(v).step_s for v in SPEEDS_M_S]
    natural_hz = body_of(mean_body()).natural_frequency_rad_s / (2 * math.pi)
    return Finding(
        "The cadence is greater than the pendulum's natural frequency",
        f"{_list(cadence_hz, 'Hz', 2)}; pendulum {natural_hz:.2f} Hz",
        min(cadence_hz) > natural_hz,
    )


def _on_the_saddle(simulations: Simulations) -> Finding:
    off_m = max(walk.com_off_saddle_m for walk in simulations.walks.values())
    return Finding(
        "The CoM stays on y_Saddle, also during the swing (eq. 2)",
        f"maximum distance from it {1e6 * off_m:.2g} µm",
        off_m < 1e-6,
    )


def _in_the_funnel(simulations: Simulations) -> Finding:
    shares = [simulations.at(v).share_inside("mos_com_m") for v in SPEEDS_M_S]
    return Finding(
        "The CoM moves in a funnel of stable points from one foot to the other (fig:09)",
        f"inside the BoS for {_list([100 * share for share in shares], '%', 0)} of the time",
        min(shares) == 1.0,
    )


def _stabler_when_faster(simulations: Simulations) -> Finding:
    least = [simulations.at(v).s_sw_min for v in SPEEDS_M_S]
    return Finding(
        "Lateral stability is slightly higher at higher speed (fig:07)",
        f"least S_SW {_list(least, '', 3)}",
        least == sorted(least) and least[0] < least[-1],
    )


def _better_than_rigid(simulations: Simulations) -> Finding:
    planner_m, rigid_m = (
        [1e3 * (of[v].vertical_m - simulations.gaits[v].vertical_m) for v in SPEEDS_M_S]
        for of in ({v: simulations.at(v) for v in SPEEDS_M_S}, simulations.rigid)
    )
    return Finding(
        "The vertical error is significantly lower than the rigid pendulum's (fig:08)",
        f"planner {_list(planner_m, 'mm', 1)}; rigid {_list(rigid_m, 'mm', 1)} off the regression",
        all(abs(ours) < abs(rigid) for ours, rigid in zip(planner_m, rigid_m, strict=True)),
    )


def _accurate_when_slow(simulations: Simulations) -> Finding:
    planner, rigid = (
        [(of[v].vertical_m - mean_m) / sd_m for v, (mean_m, sd_m) in ORENDURFF_M.items()]
        for of in ({v: simulations.at(v) for v in ORENDURFF_M}, simulations.rigid)
    )
    slow, fast = planner
    return Finding(
        "The vertical trajectory is accurate at lower speeds and beyond human variability at "
        "higher ones (fig:08)",
        f"planner {slow:+.1f} and {fast:+.1f} SD off Orendurff's people at 0.7 and 1.6 m/s, rigid "
        f"{rigid[0]:+.1f} and {rigid[1]:+.1f}; variability taken as {VARIABILITY_SD:g} SD",
        abs(slow) <= VARIABILITY_SD < fast,
    )


def _less_smooth_than_people(simulations: Simulations) -> Finding:
    jumps_mm = [1e3 * simulations.at(v).jump_m for v in SPEEDS_M_S]
    return Finding(
        "The vertical trajectory is not as smooth as a person's (fig:09n)",
        f"z jumps by {_list(jumps_mm, 'mm', 1)} at the saddle via point",
        min(jumps_mm) < -1,
    )


def _list(values: list[float], unit: str, decimals: int) -> str:
    return f"{', '.join(f'{value:.{decimals}f}' for value in values)} {unit}".strip()
