"""`saddlewalk evaluate --falls`: against the supervise command and plain loops, and its scorer."""

import csv
import gzip
import io
import itertools
import json
import math
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from saddlewalk import paths
from saddlewalk.cli import main
from saddlewalk.config import configuration
from saddlewalk.contract import LEVELS
from saddlewalk.emulation import closed_loop
from saddlewalk.emulation.wearer import Body, Wearer
from saddlewalk.evaluation import walks
from saddlewalk.evaluation.emulated import TickRecorder
from saddlewalk.evaluation.fall_pictures import (
    draw_walk,
    title_of,
    worst_false_alarms,
    worst_misses,
)
from saddlewalk.evaluation.recorded_falls import Scored
from saddlewalk.evaluation.scoring import (
    INPUTS,
    MARGINS,
    UNSTABLE,
    WINDOWS,
    Announced,
    Walk,
    figures,
    one_tick_late,
    score,
    states_of,
)
from saddlewalk.evaluation.walks import EXACT_SENSORS, draw, evaluated_walk
from saddlewalk.planning.schedule import schedule_of
from saddlewalk.recorded_states import STATE_COLUMNS
from saddlewalk.verdict import reason_name
from synthetic_falls import RUNS, write_csv, write_folder

SHARED = paths.CHECKOUT.parent / "shared"
RECIPE, FALLS = SHARED / "recipes/score_falls.py", SHARED / "data/falls"
EARLY = "roc_to_0.24_s_before_in_first_0.4_s"


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Of recorded falls. Not to be changed."""
    return write_folder(tmp_path_factory.mktemp("falls") / "falls")


def evaluate(folder: Path, *options: str) -> dict:
    path = folder.parent / "scores.json"
    assert main(["evaluate", "--falls", str(folder), "--json", str(path), *options]) == 0
    return json.loads(path.read_text())


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def announced(folder) -> dict[str, list[dict[str, str]]]:
    """By run: what `supervise` says of every fourth row, from row (number modulo 4) on."""
    config = folder.parent / "body.toml"
    config.write_text("body_mass_kg = 63.30\nbody_height_m = 1.7900\n")
    with gzip.open(folder / "states/twin.csv.gz", "rt", newline="") as file:
        rows = list(csv.DictReader(file))
    answers = {}
    for run in RUNS:
        states = [row for row in rows if row["run"] == run.name][run.number % 4 :: 4]
        source, out = folder.parent / "states.csv", folder.parent / "out.csv"
        write_csv(source, [{name: state[name] for name in STATE_COLUMNS} for state in states])
        options = ["--in", str(source), "--out", str(out), "--config", str(config)]
        assert main(["supervise", *options]) == 0
        answers[run.name] = table(out)
    return answers


def first_alarm_s(walk: dict[str, str], rows: list[dict[str, str]]) -> float:
    fall_s = float(walk["fall_time_s"] or math.inf)
    times = [float(row["t_s"]) for row in rows if row["level"] == "unstable"]
    return min((t for t in times if float(walk["push_time_s"]) <= t < fall_s), default=math.nan)


def test_rates_follow_from_the_output_of_supervise(folder, announced):
    found = evaluate(folder)["twin"]
    pushed = [walk for walk in table(folder / "walks.csv") if walk["push_time_s"]]
    alarms = {walk["run"]: first_alarm_s(walk, announced[walk["run"]]) for walk in pushed}
    falls = [walk for walk in pushed if walk["fell"] == "1"]
    leads = [float(walk["fall_time_s"]) - alarms[walk["run"]] for walk in falls]
    known = [lead for lead in leads if math.isfinite(lead)]
    upright = [math.isfinite(alarms[walk["run"]]) for walk in pushed if walk["fell"] == "0"]
    assert (found["pushed"], found["falls"]) == (7, 3) and len(known) > 0
    assert 0 < sum(upright) < len(upright)
    assert found["announced_pct"] == pytest.approx(100 * len(known) / 3)
    assert found["timely_pct"] == pytest.approx(100 * sum(lead > 0.239 for lead in known) / 3)
    assert found["lead_median_s"] == pytest.approx(np.median(known))
    assert found["alarm_though_upright_pct"] == pytest.approx(100 * np.mean(upright))
    assert found["alarms_though_upright"] == sum(upright)


def test_steady_levels_follow_from_the_output_of_supervise(folder, announced):
    found = evaluate(folder)["twin"]
    for run, begin_s in ((RUNS[0], 1.0 + 2.0), (RUNS[1], 1.0)):
        rows = announced[run.name]
        first_s = float(rows[0]["t_s"])
        levels = [row["level"] for row in rows if float(row["t_s"]) - first_s > begin_s - 1.0]
        for level in LEVELS:
            share = 100 * levels.count(level) / len(levels)
            assert found[run.kind][f"{level}_pct"] == pytest.approx(share), (run, level)
        assert found[run.kind]["minutes"] == pytest.approx(len(levels) * 0.08 / 60)


@pytest.mark.parametrize(("window", "longest_s"), WINDOWS.items())
@pytest.mark.parametrize("column", ["mos_com_m", "s_sw"])
def test_areas_count_pairs_of_a_fall_and_no_fall(window, longest_s, column, folder, announced):
    least: dict[str, list[float]] = {"0": [], "1": []}
    for walk in table(folder / "walks.csv"):
        if walk["push_time_s"]:
            end_s = min(6 + longest_s, float(walk["fall_time_s"] or 99) - 0.24) - 1e-6
            rows = [row for row in announced[walk["run"]] if 6 <= float(row["t_s"]) < end_s]
            least[walk["fell"]].append(min(float(row[column]) for row in rows if row[column]))
    pairs = [(fell, not_) for fell in least["1"] for not_ in least["0"]]
    share = sum((fell < not_) + 0.5 * (fell == not_) for fell, not_ in pairs) / len(pairs)
    assert len(pairs) == 12
    assert evaluate(folder)["twin"][window][column[:-2] if column != "s_sw" else "s_sw"] == share


def flattened(value, path=()):
    if isinstance(value, dict):
        for key, each in value.items():
            yield from flattened(each, (*path, reason_name(int(key)) if key.isdigit() else key))
    else:
        yield path, value


if RECIPE.exists():

    @pytest.mark.timeout(600)  # 15 s on a computer that does nothing else
    @pytest.mark.parametrize("recorded", ["synthetic", "machines"])
    def test_figures_are_those_of_the_recipe(recorded, folder, tmp_path):
        source, program = FALLS if recorded == "machines" else folder, Path(sys.executable).parent
        recipe, ours = tmp_path / "recipe.json", tmp_path / "ours.json"
        command = [sys.executable, RECIPE, source, program / "saddlewalk", "--json", recipe]
        subprocess.run(list(map(str, command)), check=True, capture_output=True)
        assert main(["evaluate", "--falls", str(source), "--json", str(ours)]) == 0
        found = dict(flattened(json.loads(ours.read_text())))
        for path, value in flattened(json.loads(recipe.read_text())):
            exact = not isinstance(value, float)
            assert found[path] == (value if exact else pytest.approx(value, rel=1e-12)), path


def test_figures_with_noise_and_latency_are_given_too(folder):
    one, again = evaluate(folder, "--jobs", "1"), evaluate(folder, "--jobs", "2")
    assert one == again
    other = evaluate(folder, "--seed", "2")
    exact, noise = ({**one["twin"]}, one["twin"]["noise"])
    assert noise != other["twin"]["noise"]
    assert noise[EARLY].keys() == exact[EARLY].keys() == set(MARGINS)
    late = exact["one_tick_late"]
    assert late["announced_pct"] <= exact["announced_pct"]
    assert exact["lead_median_s"] - late["lead_median_s"] == pytest.approx(0.08)
    del exact["noise"], other["twin"]["noise"]
    del exact["one_tick_late"], other["twin"]["one_tick_late"]
    assert exact == other["twin"]


def test_walkers_have_their_own_body_unless_configured(folder, tmp_path):
    (tmp_path / "other.toml").write_text("body_height_m = 1.5\nlevel_hold_ticks = 1\n")
    own = evaluate(folder)["twin"]
    assert own["config"] == {"body_mass_kg": "63.30", "body_height_m": "1.7900"}
    other = evaluate(folder, "--config", str(tmp_path / "other.toml"))["twin"]
    assert other["config"] == {
        "body_mass_kg": "63.30",
        "body_height_m": "1.5",
        "level_hold_ticks": "1.0",
    }
    assert {**other, "config": None} != {**own, "config": None}


def test_the_command_reports_and_draws(folder, tmp_path, capsys):
    out = tmp_path / "out"
    evaluate(folder, "--out", str(out))
    printed = " ".join(capsys.readouterr().out.split())
    for words in ("twin", "exact inputs", "sensor noise", "one tick late", "hof_xcom"):
        assert words in printed
    assert json.loads((out / "scores.json").read_text())["twin"]["falls"] == 3
    rows = {row["name"]: row for row in table(out / "falls.csv")}
    assert list(rows) == [run.name for run in RUNS]
    kinds = {run.name: run.kind for run in RUNS}
    alarmed = {row["name"] for row in rows.values() if row["alarm_s"] and not row["fall_s"]}
    late = {
        row["name"]
        for row in rows.values()
        if row["fall_s"] and not float(row["fall_s"]) - float(row["alarm_s"] or "nan") >= 0.24
    }
    for kind, drawn in (("false-alarms", alarmed), ("misses", late)):
        names = [f"{kind}/{k + 1:02}.png" for k in range(len(drawn))]
        assert sorted(str(path.relative_to(out)) for path in out.glob(f"{kind}/*")) == names
        assert all(f"{name} ({kinds[name]})" in printed for name in drawn)
    assert alarmed
    for path in out.rglob("*.png"):
        assert path.read_bytes().startswith(b"\x89PNG")
    assert not (out / "walks.csv").exists()


def test_emulated_and_recorded_walkers_are_in_one_table(folder, tmp_path):
    found = evaluate(folder, "--walks", "4", "--out", str(tmp_path))
    assert list(found) == ["emulated_planned", "emulated_recovery", "twin"]
    assert found["emulated_planned"].keys() <= found["twin"].keys()
    assert found["emulated_planned"]["pushed"] == 4
    assert 0.2 < found["emulated_planned"]["calm"]["minutes"] < 0.5
    assert (tmp_path / "walks.csv").exists()
    assert "cross_validation" in found["twin"]
    assert (tmp_path / "reliability.png").read_bytes().startswith(b"\x89PNG")


# One walk of 101 ticks with a push at 4 s, and what was announced of it.
PUSH_S, TICKS = 4.0, 101


def walk(fall_s=math.nan, kind="staircase", push_s=PUSH_S) -> Walk:
    rows = [[0.08 * k, 0, 0, 1, 0, 0, 0, 0.1, 0, -0.1, 1, 1] for k in range(TICKS)]
    return Walk("made-up-1", kind, push_s, fall_s, math.nan, states_of(rows), np.ones(2) / 10, 1.0)


def announcement(unstable: list[int] = (), least: dict[int, float] | None = None) -> Announced:
    level, margin = np.ones(TICKS, dtype=int), np.full(TICKS, 1.0)
    level[list(unstable)] = UNSTABLE
    for tick, value in (least or {}).items():
        margin[tick] = value
    return Announced(level, np.zeros(TICKS, dtype=int), dict.fromkeys(MARGINS, margin))


@pytest.mark.parametrize(
    ("unstable", "alarm_s"),
    [([], math.nan), ([49], math.nan), ([50], 4.0), ([49, 60, 61], 4.8), ([75], math.nan)],
)
def test_an_alarm_counts_from_the_push_to_the_fall(unstable, alarm_s):
    found = score(walk(fall_s=6.0), announcement(unstable))
    assert found.alarm_s == pytest.approx(alarm_s, nan_ok=True)
    assert found.alarm_at_push == (49 in unstable)


@pytest.mark.parametrize(("tick", "timely"), [(71, 100.0), (72, 100.0), (73, 0.0)])
def test_an_alarm_is_timely_from_three_ticks_before_the_fall(tick, timely):
    found = figures([score(walk(fall_s=6.0), announcement([tick]))], {})
    assert (found["announced_pct"], found["timely_pct"]) == (100.0, timely)


@pytest.mark.parametrize(
    ("tick", "soon", "later"),
    [(49, 1, 1), (50, -1, -1), (54, -1, -1), (55, 1, -1), (71, 1, -1), (72, 1, 1), (80, 1, 1)],
)
def test_evidence_begins_at_the_push_and_ends_before_the_fall(tick, soon, later):
    found = score(walk(fall_s=6.0), announcement(least={tick: -1.0})).least
    assert found[EARLY]["mos_com"] == soon
    assert found["roc_to_0.24_s_before"]["mos_com"] == later


def test_evidence_without_a_fall_ends_after_three_seconds():
    assert score(walk(), announcement(least={87: -1.0})).least["roc_to_0.24_s_before"]["s_sw"] == -1
    assert score(walk(), announcement(least={88: -1.0})).least["roc_to_0.24_s_before"]["s_sw"] == 1


def test_a_missing_margin_is_not_evidence():
    unknown = announcement()
    unknown.margins["s_sw"] = np.full(TICKS, math.nan)
    scores = [score(walk(fall_s=6.0), unknown), score(walk(), announcement())]
    assert math.isnan(scores[0].least[EARLY]["s_sw"])
    assert math.isnan(figures(scores, {})[EARLY]["s_sw"])
    assert figures(scores, {})[EARLY]["mos_com"] == 0.5


def test_a_tick_of_latency_delays_everything_by_a_tick():
    late = one_tick_late(announcement([50], {50: -1.0}))
    assert np.flatnonzero(late.level == UNSTABLE).tolist() == [51]
    assert LEVELS[late.level[0]] == "unknown" and reason_name(late.reason[0]) == "input"
    assert np.flatnonzero(late.margins["mos_com"] == -1).tolist() == [51]
    assert math.isnan(late.margins["mos_com"][0])


def test_a_stumble_is_an_xcom_outside_the_feet_or_a_wide_step():
    plain = score(walk(), announcement([60])).stumble
    assert plain == replace(plain, xcom_out=False, further_out=False, wide_step=False)
    out, wide = walk(), walk()
    out.states.com_m[62, 1] = 0.3
    assert score(out, announcement([60])).stumble == replace(plain, xcom_out=True, further_out=True)
    for tick in (20, 30, 62):
        wide.states.contact[tick - 1, 0] = False
    wide.states.feet_m[62, 0, 1] = 0.31
    assert score(wide, announcement([60])).stumble == replace(plain, wide_step=True)
    assert score(wide, announcement([90])).stumble == plain
    assert score(wide, announcement()).stumble is None


def made_up(walk: Walk, announced: Announced) -> Scored:
    return Scored(walk, announced, {"exact": score(walk, announced)})


def test_the_worst_misses_come_first_and_are_drawn(tmp_path):
    never, late, timely = (
        made_up(walk(fall_s=6.0), announcement(ticks)) for ticks in ([], [74], [60])
    )
    stayed_up = made_up(walk(), announcement())
    assert worst_misses([timely, late, stayed_up, never]) == [never, late]
    assert worst_misses([stayed_up, timely]) == []
    draw_walk(never, tmp_path / "never.png")
    assert (tmp_path / "never.png").read_bytes().startswith(b"\x89PNG")
    assert title_of(never).endswith("no alarm, fall 2.00 s later")
    assert title_of(late).endswith("alarm 1.92 s later, fall 2.00 s later")


def test_the_longest_false_alarms_come_first():
    fell = made_up(walk(fall_s=6.0), announcement([60]))
    short, long, before = (
        made_up(walk(), announcement(ticks)) for ticks in ([60], [60, 61], [40, 41, 42])
    )
    assert worst_false_alarms([fell, short, before, long]) == [long, short]


def test_levels_of_a_steady_walk_count_when_it_has_settled():
    calm = score(walk(kind="calm", push_s=math.nan), announcement([0, 25, 26, 100]))
    assert calm.levels["unstable"] == {"none": 2} and calm.levels["stable"] == {"none": 73}
    found = figures([calm], {})
    assert found["calm"]["unstable_pct"] == pytest.approx(100 * 2 / 75)
    assert found["pushed"] == 0 and math.isnan(found["announced_pct"])


def test_an_emulated_walk_is_scored_with_noise_without_and_late():
    config = configuration({})
    trial = replace(draw(1, 0, "planned", 63.3), impulse_n_s=60.0, direction_deg=90.0)
    noisy, exact = (walks.run(trial, config, noise) for noise in (None, EXACT_SENSORS))
    walk = evaluated_walk(trial, noisy, exact)
    assert list(walk.scores) == list(INPUTS)
    (first,), (second,), (late,) = walk.scores.values()
    assert (second.kind, second.fall_s, second.alarm_s) == ("random", *fate_of(walk))
    assert (first.fall_s, first.alarm_s) == fate_of(evaluated_walk(trial, exact, exact))
    assert late.alarm_s == pytest.approx(first.alarm_s + 0.08)
    assert first.least != second.least


def fate_of(walk) -> tuple[float, float]:
    return walk.fell_at_s, walk.alarm_at_s


def test_exact_sensors_measure_the_state_itself():
    config, schedule = configuration({}), schedule_of([(0.0, 0.0), (1.0, 1.0)], 0.1)
    wearer = Wearer(Body.of(config), EXACT_SENSORS)
    ticks = itertools.islice(closed_loop.walk(config, wearer, schedule), 40)
    assert all(tick.measured == tick.exact for tick in ticks)


def test_the_steady_part_of_an_emulated_walk_begins_with_walking():
    config, schedule = configuration({}), schedule_of([(0.0, 0.0), (1.0, 1.0), (9.0, 0.0)], 0.1)
    wearer, witness = Wearer(Body.of(config)), TickRecorder(config)
    for tick in itertools.islice(closed_loop.walk(config, wearer, schedule), 175):
        witness.see(tick, wearer)
    parts = witness.parts("start_stop", math.nan, math.nan)
    calm, whole = (score(*part) for part in parts)
    ticks = [sum(sum(each.values()) for each in part.levels.values()) for part in (calm, whole)]
    assert (calm.kind, whole.kind) == ("calm", "start_stop")
    assert 50 < ticks[0] < 100 and ticks[1] == 174


def damaged():
    yield "walkers.csv", lambda text: text.replace("63.30", "-1"), "mass_kg: '-1'"
    yield "walkers.csv", lambda text: text.split("\n")[0] + "\n", "no walkers"
    yield "walkers.csv", lambda text: text.replace("sole_width_m", "width"), "sole_width_m"
    yield "walks.csv", lambda text: text.replace("calm", "quiet"), "kind: 'quiet'"
    yield "walks.csv", lambda text: text.replace("twin-0009", "twin"), "run: 'twin'"
    yield "walks.csv", lambda text: text.replace("twin-0009", "twin-0007"), "'twin-0007' is there"
    yield "walks.csv", lambda text: text.replace("twin-0009", "twin-0010"), "no rows of twin-0010"
    yield "walks.csv", lambda text: text.replace(",twin,", ",other,"), "walker: 'other'"
    yield "walks.csv", lambda text: text.replace(",1,", ",0,", 1), "fell: '0'"
    yield "walks.csv", lambda text: text.replace("6.000", ""), "push_time_s: ''"
    yield "walks.csv", lambda text: text.replace(",90.0,", ",,"), "push_direction_deg"
    yield "walks.csv", lambda text: text.replace("1.0203", "0"), "normal_com_height_m: '0'"
    yield "states/twin.csv.gz", lambda text: text.replace(",0,1,,,,", ",0,2,,,,"), "right_contact"
    yield "states/twin.csv.gz", lambda text: text.replace(",1.0000,", ",x,", 1), "t_s: 'x'"
    yield "states/twin.csv.gz", lambda text: text.replace("0,1.0800,", "0,0.5000,"), "t_s: 0.5"


@pytest.mark.parametrize(("file", "damage", "named"), list(damaged()))
def test_a_damaged_folder_is_a_one_line_error(file, damage, named, folder, tmp_path, capsys):
    copy = Path(shutil.copytree(folder, tmp_path / "copy"))
    path = copy / file
    opened = gzip.open if path.suffix == ".gz" else io.open
    with opened(path, "rt", newline="") as whole:
        text = whole.read()
    with opened(path, "wt", newline="") as whole:
        whole.write(damage(text))
    assert damage(text) != text
    assert main(["evaluate", "--falls", str(copy), "--json", str(tmp_path / "s.json")]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1 and named in message and str(copy) in message
    assert not (tmp_path / "s.json").exists()


@pytest.mark.parametrize("content", [b"no gzip", None])
def test_a_cut_file_of_states_is_named(content, folder, tmp_path, capsys):
    copy = Path(shutil.copytree(folder, tmp_path / "copy"))
    path = copy / "states/twin.csv.gz"
    path.write_bytes(content or path.read_bytes()[:2000])
    assert main(["evaluate", "--falls", str(copy)]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1 and f"{path}: not a whole gzip file" in message
