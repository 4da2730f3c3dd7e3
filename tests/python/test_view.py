"""`saddlewalk view`: the rows of a log, the server and its token, the page in a real browser."""

import csv
import http.client
import itertools
import math
import os
import time
from array import array
from pathlib import Path
from urllib.parse import urlsplit

import lcm
import numpy as np
import pytest

from host_node import own_lcm
from page import chromium, command, go_to, opened, table, until
from saddlewalk.cli import main
from saddlewalk.contract import LEVELS, TICK_S
from saddlewalk.logs.messages import decode
from saddlewalk.transport import lcm_types
from saddlewalk.transport.bus import private_udp
from saddlewalk.transport.lcm_log import LcmLog
from saddlewalk.view.rows import NAMES, VERTICES, Rows
from saddlewalk.view.server import LiveTicks, _is_control, _wanted
from synthetic_walk import Walk, csv_text

SHOWN = (3, 40, 100, 131)  # ticks


@pytest.fixture(scope="module")
def browser():
    with chromium() as browser:
        yield browser


@pytest.fixture(scope="module")
def pushed(tmp_path_factory) -> Path:
    """The folder of a walk that ends in a fall."""
    folder = tmp_path_factory.mktemp("pushed")
    options = ["--can", private_udp(), "--lcm", own_lcm(), "--clock", "lockstep"]
    options += ["--speed", "1.2", "--duration", "9", "--push", "45@5:90", "--out", str(folder)]
    assert main(["demo", *options]) == 1
    return folder


@pytest.fixture(scope="module")
def turned(tmp_path_factory) -> Path:
    """The folder of a walk that turns to the left by more than a quarter."""
    folder = tmp_path_factory.mktemp("turned")
    schedule = folder / "schedule.csv"
    schedule.write_text("t_s,speed_m_s,turn_rad_s\n0,0,0\n1,0.8,0\n4,0.8,0.35\n11,0,0\n")
    options = ["--can", private_udp(), "--lcm", own_lcm(), "--clock", "lockstep"]
    options += ["--schedule", str(schedule), "--duration", "15", "--push", "6@8:90"]
    assert main(["demo", *options, "--out", str(folder / "walk")]) == 0
    return folder / "walk"


def rows_of(path: Path) -> dict[str, np.ndarray]:
    reader = Rows()
    rows = [reader.feed(event.channel, event.data) for event in LcmLog(path)]
    numbers = np.array([row for row in [*rows, reader.end()] if row is not None])
    return dict(zip(NAMES, numbers.T, strict=True))


def table_of(folder: Path, name: str) -> np.ndarray:
    with (folder / "walk.csv").open(newline="") as file:
        return np.array([float(row[name] or "nan") for row in csv.DictReader(file)])


def test_rows_have_the_log_s_numbers_of_each_tick(walk):
    rows = rows_of(walk / "walk.lcmlog")
    assert len(rows["tick"]) == len(table_of(walk, "t_s"))
    assert np.allclose(rows["t_s"], table_of(walk, "t_s"), atol=1e-5)  # single precision
    for name, column in (("balance.margin", "margin"), ("scores.mos_com_m", "mos_com_m")):
        # CAN carries them in steps, of 1e-3 and finer.
        assert np.allclose(rows[name], table_of(walk, column), atol=1e-3, equal_nan=True)


def test_rows_place_the_body_and_the_plan_where_the_wearer_is(walk):
    rows = rows_of(walk / "walk.lcmlog")
    for axis in "xy":
        measured = rows[f"com_{axis}_m"]
        offset = (measured - table_of(walk, f"true_com_{axis}_m")) - measured[0]
        assert np.ptp(offset[np.isfinite(offset)]) < 0.05  # a noise of 2 mm at each of 20 landings
    for side in ("left", "right"):
        apart = rows[f"plan_{side}_x_m"] - rows[f"{side}_x_m"]
        planned = table_of(walk, f"plan_{side}_x_m") - table_of(walk, f"true_{side}_x_m")
        both = np.isfinite(apart) & np.isfinite(planned)
        differ = np.abs(apart - planned)[both]
        # Noise of 2 mm, in the foot as it was first measured. The wearer holds the plan to a foot
        # that lands early, the picture to the stance foot of the plan: some ticks more.
        assert both.sum() > 100 and np.quantile(differ, 0.95) < 0.01 and differ.max() < 0.1


def test_rows_place_the_body_on_a_way_that_bends(turned):
    rows = rows_of(turned / "walk.lcmlog")
    assert rows["heading_rad"][-1] > 1.6
    for name in ("com_x_m", "com_y_m", "left_x_m", "right_y_m"):
        offset = rows[name] - table_of(turned, f"true_{name}")
        assert np.ptp(offset[np.isfinite(offset)]) < 0.06  # a noise of 2 mm at each of 20 landings
    for name in ("left_yaw_rad", "right_yaw_rad"):
        assert np.allclose(rows[name], table_of(turned, f"true_{name}"), atol=1e-4)  # CAN's steps
    forward = rows["com_vx_m_s"][75:130]  # the CoM's waves are across it
    assert forward.mean() == pytest.approx(0.8, abs=0.05)
    walked_m = np.hypot(np.diff(rows["com_x_m"]), np.diff(rows["com_y_m"])).sum()
    assert 0.9 * walked_m < rows["walked_m"][-1] - rows["walked_m"][0] < walked_m
    landing = rows["landing_yaw_rad"] - rows["heading_rad"]
    assert 0.1 < np.nanmax(landing[60:130]) < 0.4


def test_rows_have_a_push_to_the_left_of_the_heading(turned):
    rows = rows_of(turned / "walk.lcmlog")
    heading_rad = rows["heading_rad"][101]
    push_n_s = rows["truth.push_x_n_s"].sum(), rows["truth.push_y_n_s"].sum()
    assert push_n_s == pytest.approx((-6 * np.sin(heading_rad), 6 * np.cos(heading_rad)), abs=0.2)


def test_rows_have_the_pendulum_to_balance_by(walk):
    rows = rows_of(walk / "walk.lcmlog")
    walking = rows["plan.mode"] == 2
    com, cop = rows["reference_com_x_m"][walking], rows["reference_cop_x_m"][walking]
    assert np.abs(com - rows["plan_com_x_m"][walking]).max() < 0.1
    feet = np.array([rows[f"plan_{side}_x_m"][walking] for side in ("left", "right")])
    assert (cop > feet.min(axis=0) - 0.15).all() and (cop < feet.max(axis=0) + 0.15).all()


def test_a_pendulum_has_no_joints(walk):
    assert np.isnan(rows_of(walk / "walk.lcmlog")["left_knee_z_m"]).all()


def test_expected_base_of_support_contains_the_landing_that_is_planned(walk):
    rows = rows_of(walk / "walk.lcmlog")
    xs = np.array([rows[f"ebos_x_m.{index}"] for index in range(VERTICES)])
    known = np.isfinite(xs).all(axis=0)
    assert known.sum() > 100
    middle = (xs.max(axis=0) + xs.min(axis=0)) / 2
    support = np.where(rows["plan.support"] == 1, rows["right_x_m"], rows["left_x_m"])
    between = (support + rows["landing_x_m"]) / 2
    assert np.abs(middle - between)[known].max() < 1e-3


def test_a_push_and_a_fall_are_in_the_rows(pushed):
    rows = rows_of(pushed / "walk.lcmlog")
    assert rows["truth.push_y_n_s"].sum() == pytest.approx(45, rel=1e-3)
    assert abs(rows["truth.push_x_n_s"].sum()) < 1e-3
    assert rows["truth.fallen"][-1] == 1 and rows["truth.fallen"][0] == 0


def test_rows_survive_messages_that_are_none_and_members_that_are_absurd(walk):
    random = np.random.default_rng(19)
    reader, rows = Rows(), []
    for event in itertools.islice(LcmLog(walk / "walk.lcmlog"), 600):
        data = bytearray(event.data)
        for at in random.integers(8, len(data), 3):
            data[at] = random.integers(256)
        rows.append(reader.feed(event.channel, bytes(data)))
        rows.append(reader.feed(event.channel, event.data[: random.integers(20)]))
        rows.append(reader.feed("SADDLEWALK_UNHEARD_OF", event.data))
    assert {len(row) for row in rows if row is not None} == {len(NAMES)}


def test_live_ticks_keep_the_newest():
    ticks = LiveTicks()
    for tick in range(8000):
        ticks.add(array("f", [tick] * 3))
    assert (ticks.first, ticks.end) == (500, 8000)
    assert np.frombuffer(ticks.block(7000, 7002), np.float32).tolist() == [7000] * 3 + [7001] * 3


GOOD = [
    *({"push": [3, -4.5]}, {"speed": 1.2}, {"speed": 0}, {"speed": None}),
    *({"turn": -0.3}, {"turn": 0}, {"turn": None}, {"end": True}),
]
BAD = [
    *({"push": value} for value in ([0, 0], [1e3, 0], [1], ["1", 2], [math.nan, 1], 5, None)),
    *({"speed": value} for value in (-1, 99, True, "1", math.inf)),
    *({"turn": value} for value in (-1.1, 2, True, "1", math.nan)),
    *({"end": 1}, {}, {"halt": True}, {"speed": 1, "end": True}),
]


@pytest.mark.parametrize("asked", GOOD)
def test_controls_that_are_taken(asked):
    assert _is_control(asked)


@pytest.mark.parametrize("asked", BAD, ids=str)
def test_controls_that_are_not(asked):
    assert not _is_control(asked)


@pytest.mark.parametrize("wanted", [[0, 0], [5, 4], [-1, 4], [0, 11], [0.0, 4], [0], "ab", None])
def test_ticks_that_a_log_has_not_are_not_sent(wanted):
    ticks = LiveTicks()
    for _ in range(10):
        ticks.add(array("f", [1.0]))
    assert _wanted(ticks, wanted) is None
    assert _wanted(ticks, [0, 10]) is not None


def answer(url: str) -> int:
    parts = urlsplit(url)
    connection = http.client.HTTPConnection(parts.netloc, timeout=10)
    connection.request("GET", f"{parts.path}?{parts.query}")
    return connection.getresponse().status


def test_only_who_has_the_token_gets_the_page(walk):
    with command("view", str(walk / "walk.lcmlog")) as (_, url):
        assert url.startswith("http://127.0.0.1:")
        assert answer(url) == 200
        assert answer(url[:-1]) == answer(url.split("?")[0] + "?") == 403
        assert answer(url.replace("/?", "/walk?")) == 404
        assert answer(url.replace("/?", "/ticks?")) == 426  # to a WebSocket alone
        assert answer(url.split("?")[0] + "ticks?token=wrong") == 403


def test_a_port_that_is_taken_and_logs_that_are_none_are_one_line(walk, tmp_path, capsys):
    log = str(walk / "walk.lcmlog")
    with command("view", log) as (_, url):
        port = str(urlsplit(url).port)
        assert main(["view", log, "--port", port, "--no-browser"]) == 2
    assert f"--port {port}" in capsys.readouterr().err
    assert main(["view", str(walk / "walk.csv"), "--no-browser"]) == 2
    assert "is not an LCM log" in capsys.readouterr().err
    other = lcm.EventLog(str(tmp_path / "other.lcmlog"), "w")
    other.write_event(1, "POSE", b"12345678")
    other.close()
    assert main(["view", str(tmp_path / "other.lcmlog"), "--no-browser"]) == 2
    assert "no message of the firmware" in capsys.readouterr().err
    assert main(["view", log, "--lcm", "memq://", "--no-browser"]) == 2
    assert "--lcm" in capsys.readouterr().err


# ---- in the browser


def logged(path: Path, channel: str) -> list:
    """The messages of a channel, decoded by LCM's own code."""
    return [decode(event) for event in LcmLog(path) if event.channel == f"SADDLEWALK_{channel}"]


def number(value: float, digits: int, unit: str = "", sign: str = "") -> str:
    return f"{value:{sign}.{digits}f} {unit}".strip() if math.isfinite(value) else "n/a"


def test_the_page_shows_the_log_s_numbers(browser, walk):
    path = walk / "walk.lcmlog"
    balances, scores = logged(path, "BALANCE"), logged(path, "SCORES")
    verdicts, inputs = logged(path, "VERDICT"), logged(path, "INPUT")
    with command("view", str(path)) as (_, url), opened(browser, url) as page:
        for tick in SHOWN:
            go_to(page, tick)
            shown = table(page, "numbers")
            assert page.inner_text("#level").lower() == LEVELS[verdicts[tick].level]
            assert page.text_content("#margin") == number(balances[tick].margin, 3)
            assert shown["s_pend"] == number(scores[tick].s_pend, 2)
            assert shown["mos_xcom"] == number(scores[tick].mos_xcom_m, 3, "m", "+")
            assert shown["excess_stop"] == number(verdicts[tick].excess_stop_j, 1, "J", "+")
            assert shown["height"] == number(inputs[tick].com_height_m, 3, "m")
            assert page.text_content("#time") == f"{tick * TICK_S:.2f} s"
            assert table(page, "health")["faults"] == "none"


def test_a_fall_is_shown_and_its_scores_are_not(browser, pushed):
    verdicts = logged(pushed / "walk.lcmlog", "VERDICT")
    with command("view", str(pushed / "walk.lcmlog")) as (_, url), opened(browser, url) as page:
        unstable = next(i for i, v in enumerate(verdicts) if v.level == v.LEVEL_UNSTABLE)
        go_to(page, unstable)
        assert page.text_content("#reason").endswith(".")
        words, sign = page.text_content("#level"), page.get_attribute("#sign-shape", "d")
        go_to(page, len(verdicts) - 1)
        assert (words, page.text_content("#level")) == ("unstable", "fell")
        assert (page.text_content("#margin"), table(page, "numbers")["s_pend"]) == ("n/a", "n/a")
        go_to(page, 50)
        assert page.text_content("#level") == "stable"
        assert page.get_attribute("#sign-shape", "d") != sign  # not by colour alone


def test_keys_move_in_time(browser, walk):
    with command("view", str(walk / "walk.lcmlog")) as (_, url), opened(browser, url) as page:
        go_to(page, 50)
        at = "state.at"
        for key, tick in (("ArrowRight", 51), ("ArrowLeft", 50), ("Home", 0), ("End", 162)):
            page.keyboard.press(key)
            assert page.evaluate(at) == tick
        go_to(page, 50)
        page.keyboard.press("Shift+ArrowRight")
        assert page.evaluate(at) == 63
        page.keyboard.press("Space")
        until(page, "state.at > 65")
        page.keyboard.press("Space")
        paused = page.evaluate(at)
        page.wait_for_timeout(200)
        assert page.evaluate(at) == paused


@pytest.mark.parametrize("width", [320, 390, 768])
def test_the_page_fits_a_telephone(browser, walk, width):
    log = str(walk / "walk.lcmlog")
    with command("view", log) as (_, url), opened(browser, url, width, 700) as page:
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.evaluate("document.querySelector('#live').offsetParent === null")


@pytest.fixture
def own() -> list[str]:
    return ["--can", private_udp(), "--lcm", own_lcm()]


def test_a_live_walk_takes_pushes_and_speeds_from_the_page(browser, tmp_path, own):
    demo = ["demo", "--view", "--out", str(tmp_path), "--duration", "60", "--speed", "1.0", *own]
    with command(*demo, "--push", "1@59:0") as (process, url):
        with opened(browser, url) as page:
            until(page, "state.ticks.end > 60")
            assert "by the schedule" in table(page, "health")["commander"]
            assert page.text_content("#level") == "stable"
            box = page.locator("#above").bounding_box()
            com = page.evaluate("[above.board.px(above.com.x), above.board.py(above.com.y)]")
            page.mouse.move(box["x"] + com[0], box["y"] + com[1])
            page.mouse.down()
            page.mouse.move(box["x"] + com[0], box["y"] + com[1] - 30, steps=3)
            page.mouse.up()
            page.wait_for_timeout(1500)
            page.click("[data-turn='0.3']")
            until(page, "element('health').innerText.includes('by this page')")
            until(page, "above.heading > 0.05")
            page.click("#stop")
            until(page, "element('health').innerText.includes('by this page')")
            page.wait_for_timeout(600)
            page.click("#end")
            until(page, "document.querySelector('#controls').hidden")
            assert page.evaluate("state.gaps") == 0
            ticks = page.evaluate("state.ticks.end")
        assert any("the page shows the walk until Ctrl-C" in line for line in process.stdout)
    log = tmp_path / "walk.lcmlog"
    push = np.sum([message.push_n_s for message in logged(log, "TRUTH")], axis=0)
    assert push[1] > 3 and abs(push[0]) < push[1]  # to the left, as the mouse was dragged
    assert max(message.turn_rate_rad_s for message in logged(log, "TURN")) == pytest.approx(0.3)
    inputs = logged(log, "INPUT")
    assert inputs[-1].mode == lcm_types.input_t.MODE_STAND
    assert abs(len(inputs) - ticks) <= 3


def test_a_replay_is_shown_and_stays(browser, tmp_path):
    """A recording has no plan, no truth and no emulator that could be pushed."""
    recording = tmp_path / "walk.csv"
    recording.write_text(csv_text(Walk(duration_s=5.0).recording()))
    replay = ["replay", "--view", str(recording), "--lcm", own_lcm()]
    with command(*replay) as (process, url), opened(browser, url) as page:
        assert page.evaluate("element('controls').hidden")
        assert any("the page shows the walk until Ctrl-C" in line for line in process.stdout)
        assert page.evaluate("state.ticks.end") > 40
        go_to(page, 40)
        assert page.evaluate("between(state.ticks, 40)('com_x_m')") > 2.0
        assert table(page, "numbers")["height"] != "n/a"


def test_replay_refuses_a_view_without_time(capsys):
    options = ["--sample", "healthy", "--view", "--clock", "lockstep", "--no-browser"]
    assert main(["replay", *options]) == 2
    assert "--clock lockstep" in capsys.readouterr().err


def test_a_live_page_says_when_nothing_comes(browser):
    with command("view", "--lcm", own_lcm()) as (_, url):
        page = browser.new_page()
        page.goto(url)
        until(page, "document.querySelector('#level').textContent === 'unknown'")
        assert "No message from the firmware" in page.text_content("#reason")
        page.close()


def resident_kib(process_id: int) -> int:
    status = Path(f"/proc/{process_id}/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0])


def heap_bytes(page) -> int:
    """After a collection of what is not used any more."""
    page.evaluate("gc(), gc()")
    return page.evaluate("performance.memory.usedJSHeapSize")


@pytest.mark.skipif(
    "libasan" in os.environ.get("LD_PRELOAD", ""), reason="the sanitizer keeps what is freed"
)
@pytest.mark.timeout(900)
@pytest.mark.parametrize(
    ("warm_s", "for_s"),
    [
        pytest.param(8, 10, id="short"),
        pytest.param(60, 600, id="ten minutes", marks=pytest.mark.memory),
    ],
)
def test_memory_does_not_grow(browser, walk, warm_s, for_s):
    """At eight times the firmware's rate, so that the history of ten minutes is full after 75 s."""
    url_of_lcm = own_lcm()
    events = list(LcmLog(walk / "walk.lcmlog"))
    with command("view", "--lcm", url_of_lcm) as (process, url):
        bus = lcm.LCM(url_of_lcm)
        stream = Stream(bus, events)
        stream.send(2.0)
        with opened(browser, url) as page:
            stream.send(warm_s)
            heap, resident = heap_bytes(page), resident_kib(process.pid)
            before = page.evaluate("state.ticks.end")
            stream.send(for_s)
            page.wait_for_timeout(500)
            ticks = page.evaluate("state.ticks.end") - before
            page_mib = (heap_bytes(page) - heap) / 2**20
            server_mib = (resident_kib(process.pid) - resident) / 2**10
            missed = page.evaluate("state.gaps")
    print(f"{ticks} ticks: the page grew by {page_mib:.1f} MiB, the server by {server_mib:.1f} MiB")
    history_mib = 7500 * 4 * len(NAMES) / 2**20
    filled = min(for_s / (TICK_S / Stream.FASTER), 7500) / 7500  # the server's own fills up
    assert ticks > 0.9 * for_s / (TICK_S / Stream.FASTER) and missed == 0
    assert page_mib < 2 and server_mib < 2 + 1.3 * history_mib * filled


class Stream:
    """A log sent on LCM over and over, its time going on."""

    FASTER = 8

    def __init__(self, bus: lcm.LCM, events: list) -> None:
        ticks = itertools.groupby(events, lambda event: event.channel == "SADDLEWALK_INPUT")
        self._bus, self._ticks = bus, itertools.cycle([list(group) for _, group in ticks])
        self._utime_us = 0

    def send(self, for_s: float) -> None:
        end_s = due_s = time.monotonic()
        end_s += for_s
        while due_s < end_s:
            for event in itertools.chain(next(self._ticks), next(self._ticks)):
                utime = self._utime_us.to_bytes(8, "big")
                self._bus.publish(event.channel, event.data[:8] + utime + event.data[16:])
            self._utime_us += round(TICK_S * 1e6)
            due_s += TICK_S / self.FASTER
            time.sleep(max(0.0, due_s - time.monotonic()))
