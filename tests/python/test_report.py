"""`saddlewalk report`: the page's numbers are the log's, and missing data are reported."""

import html.parser
import math
import re
from collections import Counter
from itertools import pairwise
from pathlib import Path

import lcm
import numpy as np
import pytest
from matplotlib.figure import Figure

from page import chromium
from saddlewalk.cli import main
from saddlewalk.contract import LEVELS, SIDES, TICK_S
from saddlewalk.logs.messages import decode
from saddlewalk.session import page as session_page
from saddlewalk.session import pictures
from saddlewalk.session.runs import load_session
from saddlewalk.session.steps import variability, walked
from saddlewalk.transport.lcm_log import Event, LcmLog
from saddlewalk.verdict import reason_words

TICKS = 163  # of the walk of 13 s
AGES = ("age of", "median (ms)", "95 % below (ms)", "oldest (ms)", "ticks before the first one")
PROBLEMS = ("fault or limit", "meaning", "times", "total (s)", "first at (s)", "last at (s)")
ALARMS = ("start (s)", "duration (s)", "level", "lowest margin", "driven by", "reason")
GAIT = ("what", "unit", "measured", "default, not calibrated", "published", "what it means")
VARIABILITY = ("steps", "foot", "what", "number", "mean", "SD", "CV")


class Page(html.parser.HTMLParser):
    """What a browser makes of a page: words, tables by their header, addresses."""

    def __init__(self) -> None:
        super().__init__()
        self.tables: dict[tuple[str, ...], list[list[str]]] = {}
        self.addresses: list[str] = []
        self.tags: Counter[str] = Counter()
        self.open_tags: list[str] = []
        self.text = ""

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)

    def handle_starttag(self, tag, attributes):
        self.tags[tag] += 1
        self.addresses += [value for name, value in attributes if name in ("src", "href")]
        if tag not in ("meta", "img", "br", "hr"):
            self.open_tags.append(tag)
        if tag == "table":
            self.rows = []
        elif tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_endtag(self, tag):
        assert self.open_tags.pop() == tag
        if tag == "table":
            self.tables.setdefault(tuple(self.rows[0]), []).extend(self.rows[1:])

    def handle_data(self, data):
        if "style" in self.open_tags:
            assert "url(" not in data and "@import" not in data
        elif {"td", "th"} & set(self.open_tags):
            self.rows[-1][-1] += data
        else:
            self.text += data

    def values(self, *header: str) -> dict[str, str]:
        """A table of two columns."""
        return dict(self.tables[header])

    @property
    def short(self) -> dict[str, str]:
        return self.values("what", "how much")


@pytest.fixture
def unseen(monkeypatch) -> None:
    """Pages without the pictures, which take a second to draw."""
    blank = dict.fromkeys(("level", "scores"), pictures.Picture("", b""))
    monkeypatch.setattr(session_page, "draw", lambda *_: blank)


def read(path: Path) -> Page:
    page = Page()
    page.feed(path.read_text(encoding="utf-8"))
    page.close()
    assert not page.open_tags
    return page


def report(log: Path, out: Path, status: int = 0) -> Page:
    assert main(["report", str(log), "--out", str(out)]) == status
    return read(out)


def events_of(walk: Path) -> list[Event]:
    return list(LcmLog(walk / "walk.lcmlog"))


def write_events(path: Path, events: list[Event]) -> Path:
    log = lcm.EventLog(str(path), "w", overwrite=True)
    for event in events:
        log.write_event(event.logged_us, event.channel, event.data)
    log.close()
    return path


def without(events: list[Event], *names: str) -> list[Event]:
    return [event for event in events if event.channel not in {f"SADDLEWALK_{n}" for n in names}]


def messages(events: list[Event], name: str) -> list:
    return [decode(event) for event in events if event.channel == f"SADDLEWALK_{name}"]


def changed(events: list[Event], name: str, change) -> list[Event]:
    """change: (how manieth message, message), which it may change."""
    out, count = [], 0
    for event in events:
        if event.channel == f"SADDLEWALK_{name}":
            message = decode(event)
            change(count, message)
            event = Event(event.logged_us, event.channel, message.encode())
            count += 1
        out.append(event)
    return out


@pytest.fixture(scope="module")
def page(walk, tmp_path_factory) -> Page:
    return report(walk / "walk.lcmlog", tmp_path_factory.mktemp("report") / "report.html")


def test_the_page_is_self_contained(page):
    assert page.tags["img"] == 3 and "No faults or limits were reported." in page.text
    assert page.addresses and all(a.startswith("data:image/png;base64,") for a in page.addresses)
    assert not page.tags.keys() & {"script", "link", "iframe", "object"}
    assert "Saddlewalk is not a medical device." in page.text


def test_time_in_levels_matches_the_log(walk, page):
    levels = Counter(LEVELS[message.level] for message in messages(events_of(walk), "VERDICT"))
    rows = page.tables["level", "time (s)", "share"]
    assert [row[0] for row in rows] == ["stable", "caution", "unstable", "unknown"]
    for name, held_s, share in rows:
        assert float(held_s) == pytest.approx(levels[name] * TICK_S, abs=0.005)
        assert float(share.rstrip("%")) == pytest.approx(100 * levels[name] / TICKS, abs=0.05)
    assert levels["stable"] > 100


def test_distance_and_speed_are_the_wearers(walk, page):
    truth = messages(events_of(walk), "TRUTH")
    walked_m = truth[-2].com_m[0] - truth[0].com_m[0]  # the truth after a tick is the next one's
    matched = re.fullmatch(r"(\S+) m, measured", page.short["distance of the CoM"])
    assert float(matched[1]) == pytest.approx(walked_m, abs=0.03) and walked_m > 10
    assert page.short["duration"] == f"{TICKS * TICK_S:.2f} s"
    speed = float(page.short["mean speed, over the steps"].removesuffix(" m/s"))
    assert 0.8 * 1.2 < speed < 1.02 * 1.2  # with the start


def test_steps_are_those_of_the_wearers_feet(walk, page):
    """Against the truth: a foot that comes down, and where the feet are then."""
    truth = messages(events_of(walk), "TRUTH")
    landed = {"left": [], "right": []}
    for before, after in pairwise(truth):
        for side, feet in landed.items():
            if getattr(after, f"{side}_contact") > getattr(before, f"{side}_contact"):
                ahead_m = after.left_m[0] - after.right_m[0]
                length_m = ahead_m if side == "left" else -ahead_m
                feet.append((length_m, after.left_m[1] - after.right_m[1]))
    rows = {tuple(row[:3]): row[3:] for row in page.tables[VARIABILITY]}
    for side, feet in landed.items():
        assert len(feet) > 5
        for column, what in enumerate(("step length (m)", "step width (m)")):
            number, mean, sd, cv = rows["all", side, what]
            values = [foot[column] for foot in feet]
            assert int(number) == len(feet)
            assert float(mean) == pytest.approx(np.mean(values), abs=0.01)
            assert float(sd) == pytest.approx(np.std(values, ddof=1), abs=0.01)
            assert cv == f"{100 * float(sd) / float(mean):.1f} %" or float(mean) < 0.5
    steady = rows["steady", "both", "step time (s)"]
    assert 3 <= int(steady[0]) < sum(map(len, landed.values()))
    assert float(steady[1]) == pytest.approx(2 * (0.1802 * 1.2 + 0.1351) / 1.2, abs=0.04)


def test_gait_is_that_of_the_steady_steps_beside_the_configuration_and_norms(walk, page):
    rows = {row[0]: row[1:] for row in page.tables[GAIT]}
    steady = {tuple(row[:3]): row[3:] for row in page.tables[VARIABILITY] if row[0] == "steady"}
    for what, label in (("step length", "step length (m)"), ("step width", "step width (m)")):
        assert float(rows[what][1]) == pytest.approx(
            float(steady["steady", "both", label][1]), abs=6e-4
        )
    time_s = float(steady["steady", "both", "step time (s)"][1])
    assert float(rows["cadence"][1]) == pytest.approx(60 / time_s, rel=2e-3)
    left, right = (float(steady["steady", side, "step length (m)"][1]) for side in SIDES)
    index = 200 * (left - right) / (left + right)
    assert float(rows["symmetry index, step length"][1]) == pytest.approx(index, abs=0.3)
    speed = float(re.search(r"steps at (\S+) m/s", page.text)[1])
    assert float(rows["step length"][2]) == pytest.approx(2 * (0.1802 * speed + 0.1351), abs=4e-3)
    assert rows["cadence"][3] == "107 ± 10"  # 0.56 ± 0.05 s a step
    assert rows["step length"][3] == "0.81 ± 0.09"  # of a leg of 0.53 of 1.79 m
    truth = messages(events_of(walk), "TRUTH")
    both = [one.left_contact and one.right_contact for one in truth[40:-40]]
    assert float(rows["double support"][1]) == pytest.approx(100 * np.mean(both), abs=6)


def test_gait_without_steps_or_with_an_absurd_configuration_is_reported(walk, tmp_path, unseen):
    def spoil(_, config):
        config.value = [math.nan, *config.value[1:]]
        config.name = [*config.name[:-1], "nose"]

    events = changed(events_of(walk), "CONFIG", spoil)
    page = report(write_events(tmp_path / "spoilt.lcmlog", events), tmp_path / "spoilt.html")
    assert GAIT in page.tables
    page = report(
        write_events(tmp_path / "none.lcmlog", without(events_of(walk), "INPUT", "PLAN")),
        tmp_path / "none.html",
    )
    assert GAIT not in page.tables


def test_variability_is_that_of_the_sample():
    spread = variability([1.0, 2.0, math.nan, 3.0])
    assert (spread.steps, spread.mean, spread.sd, spread.cv) == (3, 2.0, 1.0, 0.5)
    assert math.isnan(variability([1.0]).sd) and math.isnan(variability([]).mean)


def test_what_was_seen_is_in_sentences(walk, page):
    steps = walked(load_session(walk / "walk.lcmlog").runs[0]).steps
    steady = steps.where(steps.steady)
    cadence, speed_m_s = 60 / steady.time_s.mean(), steady.speed_m_s
    assert (
        f"The person took {len(steps)} steps in 13 s and covered 13.1 m. The steady steps came at "
        f"{cadence:.0f} a minute, at {speed_m_s:.1f} m/s." in page.text
    )
    assert "Balance was stable for 13 s, without an alarm." in page.text
    left, right = (steady.length_m[steady.side == side].mean() for side in (0, 1))
    longer, percent = "left" if left > right else "right", 200 * abs(left - right) / (left + right)
    assert f"The {longer} foot's steps were longer by {percent:.0f} %, which is not" in page.text


def test_the_clinicians_part_prints_on_two_pages(walk, tmp_path):
    def alarm(tick, verdict):
        verdict.level, verdict.reason = (3, 3) if 100 <= tick < 110 else (1, 0)

    log = write_events(tmp_path / "log", changed(events_of(walk), "VERDICT", alarm))
    report(log, tmp_path / "a.html")
    with chromium() as browser:
        printed = browser.new_page()
        printed.goto((tmp_path / "a.html").as_uri())
        pdf = printed.pdf(prefer_css_page_size=True)
        printed.emulate_media(media="print")
        seen = printed.inner_text("body")
    assert len(re.findall(rb"/Type\s*/Page\b", pdf)) == 2
    assert "What was seen" in seen and "Gait" in seen
    assert "Data quality: no measurement was missing, late or implausible." in seen
    assert "Configuration" not in seen and "ticks in the log" not in seen


def test_alarms_have_start_duration_level_and_reason(walk, tmp_path, unseen):
    def alarm(tick, verdict):
        verdict.level, verdict.reason = 1, 0
        if 40 <= tick < 50:
            verdict.level, verdict.reason = 2, 9 if tick < 45 else 10
        elif 50 <= tick < 53:
            verdict.level, verdict.reason = 3, 3

    def margin(tick, balance):
        balance.margin, balance.driver = 0.5, 13
        if 40 <= tick < 50:
            balance.margin, balance.driver = (0.05, 14) if tick == 44 else (0.08, 15)
        elif 50 <= tick < 53:
            balance.margin, balance.driver = -0.01 * (tick - 49), 16

    events = changed(changed(events_of(walk), "VERDICT", alarm), "BALANCE", margin)
    page = report(write_events(tmp_path / "log", events), tmp_path / "a.html")
    lowest = f"-0.030 at 4.16 s: {reason_words(16)}; unstable begins at 0"
    assert page.short["lowest margin"] == lowest
    both = f"{reason_words(9)}; {reason_words(10)}"
    assert page.tables[ALARMS] == [
        ["3.20", "0.80", "caution", "0.050", reason_words(14), both],
        ["4.00", "0.24", "unstable", "-0.030", reason_words(16), reason_words(3)],
    ]
    assert page.short["episodes by level"] == "unstable 1, caution 1, unknown 0"
    assert "Balance was stable for 12 s, in caution for 0.8 s and unstable for 0.2 s." in page.text
    assert f"The worst began at 4.0 s and lasted 0.2 s: {reason_words(16)}." in page.text
    assert ["unstable", "0.24", f"{3 / TICKS:.1%}"] in page.tables["level", "time (s)", "share"]


def test_alarms_of_a_log_without_margins_have_none(walk, tmp_path, unseen):
    def alarm(tick, verdict):
        verdict.level, verdict.reason = (2, 9) if tick == 40 else (1, 0)

    events = without(changed(events_of(walk), "VERDICT", alarm), "BALANCE")
    page = report(write_events(tmp_path / "log", events), tmp_path / "a.html")
    row = ["3.20", "0.08", "caution", "not known", "not known", reason_words(9)]
    assert page.tables[ALARMS] == [row] and page.short["lowest margin"] == "not known"


def test_a_fall_has_its_time_on_the_page_and_in_the_pictures(walk, tmp_path, unseen, page):
    assert "the wearer fell" not in page.short and "and did not fall." in page.text

    def fall(tick, truth):
        truth.fallen = tick >= 100

    log = write_events(tmp_path / "log", changed(events_of(walk), "TRUTH", fall))
    fallen = report(log, tmp_path / "a.html")
    assert "was emulated (SADDLEWALK_TRUTH) and fell." in fallen.text
    margins = [message.margin for message in messages(events_of(walk), "BALANCE")]
    assert fallen.short["lowest margin"].startswith(f"{min(margins[:100]):.3f} at ")
    assert re.fullmatch(r"at 8\.\d\d s: scores, levels and .*", fallen.short["the wearer fell"])
    assert "The wearer fell, 8.0 s after the beginning." in fallen.text
    (run,) = load_session(log).runs
    assert run.fell_s == pytest.approx(100 * TICK_S, abs=0.001)
    figure = Figure()
    axes = figure.subplots()
    pictures._finish_time(figure, run)
    assert list(axes.lines[0].get_xdata()) == [run.fell_s, run.fell_s]


def test_the_worst_alarms_of_a_long_run_are_shown_in_detail(walk, tmp_path, monkeypatch):
    def alarm(tick, verdict):
        starts = {20: 2, 40: 3, 60: 2, 61: 2, 80: 2, 81: 2, 82: 2}
        verdict.level, verdict.reason = starts.get(tick, 1), 0

    monkeypatch.setattr(pictures, "LONG_S", 5.0)
    log = write_events(tmp_path / "log", changed(events_of(walk), "VERDICT", alarm))
    page = report(log, tmp_path / "a.html")
    views = re.findall(r"Detail: (\w+) from (\S+) s\.", page.text)
    assert views == [("unstable", "3.20"), ("caution", "4.80"), ("caution", "6.40")]
    assert "Each alarm (the worst 8 if there are more)" in page.text


def test_faults_late_ticks_and_rejected_frames_are_reported(walk, tmp_path):
    def health(tick, message):
        message.faults = 1 << 3 if tick in (20, 21, 30) else 0
        message.limits = message.status = 0

    def status(tick, message):
        message.late_ticks, message.missed_ticks = tick, 4
        message.frames_bad_crc, message.frames_accepted = 7, 1234

    events = changed(changed(events_of(walk), "HEALTH", health), "STATUS", status)
    page = report(write_events(tmp_path / "log", events), tmp_path / "a.html")
    ((name, words, *numbers),) = page.tables[PROBLEMS]
    assert (name, numbers) == ("LEFT_STALE", ["2", "0.24", "1.60", "2.40"])
    assert words == "the left foot's measurement is too old"
    assert f"Data quality: {words} (0.2 s)." in page.text
    assert f"{TICKS - 1} ticks late, 4 missed" in page.short["timing, since the firmware's start"]
    text = page.short["CAN, since the firmware's start"]
    assert text.startswith("1234 frames accepted, rejected: 7 bad CRC")
    assert page.tags["img"] == 4 and "When each fault and limit was reported." in page.text


def test_ages_are_those_of_the_inputs(walk, tmp_path, unseen):
    def age(tick, message):
        message.left_age_us = -1 if tick < 3 else 1000 * (tick - 3)

    log = write_events(tmp_path / "log", changed(events_of(walk), "INPUT", age))
    rows = report(log, tmp_path / "a.html").tables[AGES]
    median, usual = np.percentile(range(TICKS - 3), (50, 95))
    assert ["left foot", f"{median:.0f}", f"{usual:.0f}", f"{TICKS - 4}", "3"] in rows


def test_gaps_are_reported_and_a_silence_has_no_level(walk, tmp_path, unseen):
    """A few ticks are bridged; of seconds nothing is known."""
    lost = {*range(30, 33), *range(60, 100)}
    events = [e for e in events_of(walk) if round(utime_us(e) / 80000) not in lost]
    page = report(write_events(tmp_path / "log", events), tmp_path / "a.html")
    rows = page.tables["gap from (s)", "duration (s)", "which"]
    assert rows == [
        ["2.40", "0.24", "3 ticks are not in the log"],
        ["4.80", "3.20", "40 ticks are not in the log"],
    ]
    assert page.short["gaps"] == "2, 3.44 s in all"
    times_s = [float(row[1]) for row in page.tables["level", "time (s)", "share"]]
    assert sum(times_s) == pytest.approx(TICKS * TICK_S, abs=0.03)
    assert ["silent", "3.20", f"{40 / TICKS:.1%}"] in page.tables["level", "time (s)", "share"]
    assert "not known during 3.28 s" in page.short["distance of the CoM"]


def utime_us(event: Event) -> int:
    return decode(event).utime_us


def test_a_log_without_verdicts_says_so(walk, tmp_path, unseen):
    log = write_events(tmp_path / "log", without(events_of(walk), "VERDICT"))
    page = report(log, tmp_path / "a.html")
    assert "No verdict was logged." in page.text and ALARMS not in page.tables
    assert "was received on SADDLEWALK_VERDICT: levels, alarms, energies" in page.text
    assert page.short["episodes by level"] == "not known"


def test_without_inputs_steps_are_from_the_plan(walk, tmp_path):
    events = events_of(walk)
    log = write_events(tmp_path / "log", without(events, "INPUT"))
    page = report(log, tmp_path / "a.html")
    plans = messages(events, "PLAN")
    assert page.short["steps"] == f"{plans[-1].step_count}, planned"
    walked_m = plans[-1].origin_x_m + plans[-1].com_m[0] - plans[0].com_m[0]
    assert page.short["distance of the CoM"] == f"{walked_m:.2f} m, planned"
    assert "From the plan, not from the person" in " ".join(page.text.split())
    assert "was received on SADDLEWALK_INPUT: measurements" in page.text and AGES not in page.tables
    rows = {tuple(row[:3]): row[3:] for row in page.tables[VARIABILITY]}
    of_model = {"step length (m)": 2 * (0.1802 * 1.2 + 0.1351), "step width (m)": 0.1}
    for what, value in of_model.items():
        number, mean, _, _ = rows["steady", "both", what]
        assert int(number) > 3 and float(mean) == pytest.approx(value, abs=0.005)


def test_a_log_of_scores_only_gives_a_page(walk, tmp_path):
    events = [e for e in events_of(walk) if e.channel == "SADDLEWALK_SCORES"]
    page = report(write_events(tmp_path / "log", events), tmp_path / "a.html")
    assert page.text.count("Nothing readable was received on") == 7
    assert page.short["steps, distance, speed"] == "not known"
    assert "Neither measured feet nor a plan was logged." in page.text


def test_configuration_and_versions_are_the_logs(walk, page):
    config = messages(events_of(walk), "CONFIG")[0]
    columns = page.values("what", "value")
    assert columns["library"] == config.library_version and columns["clock"] == "lockstep"
    values = {name: float(columns[name]) for name in config.name}
    assert values == pytest.approx(dict(zip(config.name, config.value, strict=True)), rel=1e-6)


def test_each_run_has_its_own_part(walk, tmp_path, unseen):
    events = events_of(walk)
    page = report(write_events(tmp_path / "log", [*events, *events]), tmp_path / "a.html")
    assert "Run 1 of 2" in page.text and "Run 2 of 2" in page.text
    durations = [row for row in page.tables["what", "how much"] if row[0] == "duration"]
    assert durations == [["duration", f"{TICKS * TICK_S:.2f} s"]] * 2


def test_a_run_ends_where_time_or_tick_number_goes_back(walk, tmp_path):
    def later(_, message):
        message.utime_us += 60_000_000

    scores = [event for event in events_of(walk) if event.channel == "SADDLEWALK_SCORES"]
    health = [event for event in events_of(walk) if event.channel == "SADDLEWALK_HEALTH"]
    for once, again in ((scores, scores), (health, changed(health, "HEALTH", later))):
        log = write_events(tmp_path / "log", [*once, *again])
        assert [run.ticks for run in load_session(log).runs] == [TICKS, TICKS]


def test_a_configuration_alone_is_not_a_tick(walk, tmp_path):
    """As when the logger was stopped between it and the rest of its tick."""
    events = events_of(walk)
    last = max(i for i, event in enumerate(events) if event.channel == "SADDLEWALK_CONFIG")
    (run,) = load_session(write_events(tmp_path / "log", events[: last + 1])).runs
    assert run.ticks == utime_us(events[last]) // 80000
    assert run.has("config")


def test_text_of_a_log_is_text_on_the_page(walk, tmp_path, unseen):
    evil = '<script src="http://x/y">|![a](http://x/z)'

    def version(_, config):
        config.library_version = evil

    events = changed(events_of(walk), "CONFIG", version)
    events.append(Event(events[-1].logged_us, "A<img src=x>", b"other"))
    page = report(write_events(tmp_path / "log", events), tmp_path / "a.html")
    assert page.values("what", "value")["library"] == evil
    assert "1 on A<img src=x>" in page.text
    assert all(address.startswith("data:") for address in page.addresses)


def test_a_truncated_log_is_reported_as_far_as_possible(walk, tmp_path, unseen, capsys):
    cut = tmp_path / "cut.lcmlog"
    cut.write_bytes((walk / "walk.lcmlog").read_bytes()[:100000])
    page = report(cut, tmp_path / "a.html", status=1)
    assert "The log is incomplete:" in page.text
    assert "incomplete: " in capsys.readouterr().err


def rejection_of(arguments: list[str], capsys) -> str:
    assert main(["report", *arguments]) == 2
    printed = capsys.readouterr()
    assert (printed.out, printed.err.count("\n")) == ("", 1)
    return printed.err


def test_unknown_logs_and_two_firmwares_at_once_are_rejected(walk, tmp_path, capsys):
    others = write_events(tmp_path / "others", [Event(1, "CAMERA", b"picture")])
    assert "1 messages, on 'CAMERA', is one" in rejection_of([str(others)], capsys)
    health = [e for e in events_of(walk) if e.channel == "SADDLEWALK_HEALTH"]
    both = [event for pair in zip(health[50:], health, strict=False) for event in pair]
    log = write_events(tmp_path / "both", both)
    assert "two firmware processes are logged at once" in rejection_of([str(log)], capsys)
    assert {path.name for path in tmp_path.iterdir()} == {"others", "both"}


def test_where_it_is_written(walk, tmp_path, unseen, capsys):
    log = write_events(tmp_path / "a.lcmlog", events_of(walk)[:200])
    assert main(["report", str(log)]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == str(tmp_path / "a.lcmlog.html")
    deep, missing = str(tmp_path / "no" / "where.html"), str(tmp_path / "none")
    assert f"--out {deep}" in rejection_of([str(log), "--out", deep], capsys)
    assert f"--out {tmp_path}" in rejection_of([str(log), "--out", str(tmp_path)], capsys)
    assert f"is the same file as LOG {log}" in rejection_of([str(log), "--out", str(log)], capsys)
    assert f"{missing}: No such file" in rejection_of([missing], capsys)
    assert {path.name for path in tmp_path.iterdir()} == {"a.lcmlog", "a.lcmlog.html"}
