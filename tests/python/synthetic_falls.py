"""A folder of recorded falls: a planned walk as if measured, pushed to the left or not."""

import csv
import gzip
import math
from dataclasses import dataclass
from pathlib import Path

from twin import Twin

ROW_S = 0.02
PUSH_S = 6.0
BEGIN_S, AFTER_S, AFTER_FALL_S = 1.0, 4.0, 0.5
FALL_HEIGHT = 0.75
STATES = (
    "run t_s com_x_m com_y_m com_z_m com_vx_m_s com_vy_m_s left_x_m left_y_m right_x_m right_y_m "
    "left_contact right_contact left_cop_x_m left_cop_y_m right_cop_x_m right_cop_y_m"
).split()
WALKS = (
    "run walker kind speed_m_s push_time_s push_duration_s push_direction_deg push_n_s fell "
    "fall_time_s ground_contact_time_s normal_com_height_m"
).split()
WALKER = {
    "walker": "twin",
    "mass_kg": "63.30",
    "com_height_standing_m": "1.0203",
    "com_height_walking_m": "1.0203",
    "sole_length_m": "0.260",
    "sole_width_m": "0.090",
}


@dataclass(frozen=True)
class Run:
    """departs_m: how far the CoM goes to the left; rate_s: grows so fast, or below 0 fades."""

    number: int
    kind: str
    departs_m: float = 0.0
    rate_s: float = 0.0

    @property
    def name(self) -> str:
        return f"twin-{self.number:04d}"

    @property
    def pushed(self) -> bool:
        return self.departs_m > 0

    def departure(self, since_s: float) -> tuple[float, float]:
        """Of the CoM, m and m/s."""
        if not self.pushed or since_s <= 0:
            return 0.0, 0.0
        if self.rate_s > 0:
            grown = math.exp(self.rate_s * since_s)
            return self.departs_m * (grown - 1), self.departs_m * self.rate_s * grown
        fades = math.exp(self.rate_s * since_s)
        return (
            self.departs_m * since_s * fades,
            self.departs_m * fades * (1 + self.rate_s * since_s),
        )


RUNS = (
    Run(0, "calm"),
    Run(1, "start_stop"),
    Run(2, "staircase", 0.05, 3.0),
    Run(3, "staircase", 0.02, 5.0),
    Run(4, "random", 0.01, 6.0),
    Run(5, "random", 0.05, -2.0),
    Run(6, "staircase", 0.3, -2.0),
    Run(7, "random", 1.2, -2.0),
    Run(9, "random", 2.5, -2.0),
)


def rows_of(run: Run, twin: Twin) -> tuple[list[dict[str, str]], float]:
    """Its states, and when it fell: NaN if it did not."""
    rows, fall_s = [], math.nan
    for k in range(round((PUSH_S - BEGIN_S + AFTER_S) / ROW_S)):
        t = BEGIN_S + k * ROW_S
        if t > fall_s + AFTER_FALL_S:
            break
        aside, rate = run.departure(t - PUSH_S)
        height = twin.com_z(t) * (1 - 0.6 * min(aside, 1.0) ** 2)
        if math.isnan(fall_s) and height < FALL_HEIGHT * twin.pendulum:
            fall_s = t
        (x, y), (vx, vy), feet = twin.com_xy(t), twin.com_xy_velocity(t), twin.feet(t)
        places = [*feet["left"], *feet["right"]]
        numbers = [t, x, y + aside, height, vx, vy + rate, *places]
        stands = [int(twin.support(t) == side) for side in ("left", "right")]
        cells = [run.name, *(f"{number:.4f}" for number in numbers), *map(str, stands), *[""] * 4]
        rows.append(dict(zip(STATES, cells, strict=True)))
    return rows, fall_s


def walk_row(run: Run, fall_s: float, twin: Twin) -> dict[str, str]:
    push = ["6.000", "0.100", "90.0", f"{100 * run.departs_m:.1f}"] if run.pushed else [""] * 4
    fell = ["1", f"{fall_s:.3f}", ""] if math.isfinite(fall_s) else ["0", "", ""]
    cells = [run.name, "twin", run.kind, "1.000", *push, *fell, f"{twin.pendulum:.4f}"]
    return dict(zip(WALKS, cells, strict=True))


def write_folder(folder: Path) -> Path:
    twin = Twin(1.0, 0.0)
    (folder / "states").mkdir(parents=True)
    recorded = [(run, *rows_of(run, twin)) for run in RUNS]
    write_csv(folder / "walkers.csv", [WALKER])
    write_csv(folder / "walks.csv", [walk_row(run, fall_s, twin) for run, _, fall_s in recorded])
    with gzip.open(folder / "states/twin.csv.gz", "wt", newline="") as file:
        write_rows(file, [row for _, rows, _ in recorded for row in rows])
    return folder


def write_csv(path: Path, rows: list[dict[str, str]]) -> None:
    with path.open("w", newline="") as file:
        write_rows(file, rows)


def write_rows(file, rows: list[dict[str, str]]) -> None:
    writer = csv.DictWriter(file, list(rows[0]), extrasaction="ignore")
    writer.writeheader()
    writer.writerows(rows)
