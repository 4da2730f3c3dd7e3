"""The playground: its page in a real browser, against the commands that run the same core."""

import csv
import io
import os
import subprocess

import pytest

from page import chromium, table, watched
from saddlewalk import paths
from saddlewalk.cli import main
from sanitizer import WITHOUT

ROWS = 15
TEXT = ("phase", "support", "t_s", "theta_rad")  # of the CSV, and not floats of the plan


@pytest.fixture(scope="module")
def page():
    with chromium() as browser:
        made = subprocess.run(
            ["make", "playground"],
            cwd=paths.CHECKOUT,
            env={**WITHOUT, "SADDLEWALK_BUILD": ""},
            capture_output=True,
            text=True,
        )
        if made.returncode and "wasm" in made.stdout + made.stderr and "CI" not in os.environ:
            pytest.skip("WebAssembly: apt install clang lld wasi-libc libclang-rt-dev-wasm32")
        assert made.returncode == 0, made.stdout + made.stderr
        url = (paths.CHECKOUT / "build/playground.html").as_uri()
        with watched(browser, url) as page:
            page.goto(url)
            yield page


@pytest.fixture(autouse=True)
def planned(page):
    page.click("#reset")


@pytest.mark.parametrize("ankle", ["erf", "rigid", "cycloid"])
def test_the_plan_has_the_bits_of_the_command(page, capsys, ankle):
    assert main(["plan", "--speed", "1.2", "--ankle", ankle, "--strides", "2"]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))[:ROWS]
    page.select_option("#ankle", str(("erf", "rigid", "cycloid").index(ankle)))
    shown = page.evaluate(
        f"plan({ROWS}, 80000).map(row => Object.fromEntries(ROW.map(name => [name, row(name)])))"
    )
    page.select_option("#ankle", "0")
    for row, numbers in zip(rows, shown, strict=True):
        for name in row.keys() - set(TEXT):
            # Positions along the walk have the walked distance added, in single precision.
            near = 1e-6 if name.endswith("_x_m") else 0.0
            assert numbers[name] == pytest.approx(float(row[name]), rel=0, abs=near), name
        assert numbers["phase"] == int(row["phase"])


def test_a_planned_posture_is_stable(page):
    assert page.text_content("#level") == "stable"
    assert table(page, "numbers")["excess_track"].endswith("the ankles can absorb it")


def drag(page, what: str, forward_px: float, up_px: float) -> None:
    place = f"state.probed.read('{what}_x_m')", f"state.probed.read('{what}_y_m')"
    x, y = page.evaluate(f"[above.px({place[0]}), above.py({place[1]})]")
    box = page.locator("#above").bounding_box()
    page.mouse.move(box["x"] + x, box["y"] + y)
    page.mouse.down()
    page.mouse.move(box["x"] + x + forward_px, box["y"] + y - up_px, steps=4)
    page.mouse.up()


def test_an_xcom_that_is_dragged_away_is_unstable_and_its_reason_is_told(page):
    drag(page, "xcom", 10, 110)
    assert page.text_content("#level") == "unstable"
    assert page.text_content("#reason").endswith(".")
    assert float(page.text_content("#margin")) < 0
    assert "cannot catch" in table(page, "numbers")["driver"]
    page.click("#reset")
    assert page.text_content("#level") == "stable"


def test_a_dragged_xcom_is_where_the_pointer_is(page):
    read = "[state.probed.read('xcom_x_m'), state.probed.read('xcom_y_m')]"
    before = page.evaluate(read)
    drag(page, "xcom", 20, 30)
    moved = [b - a for a, b in zip(before, page.evaluate(read), strict=True)]
    scale = page.evaluate("above.scale")
    assert moved == pytest.approx([20 / scale, 30 / scale], abs=1e-3)


def test_keys_move_the_com(page):
    before = page.evaluate("state.probed.read('com_y_m')")
    page.focus("#above")
    page.keyboard.press("ArrowUp")
    assert page.evaluate("state.probed.read('com_y_m')") == pytest.approx(before + 0.01, abs=1e-6)


def test_a_body_that_no_walk_can_be_planned_for_is_told(page):
    page.evaluate("(state.body_height_m = 0.2, draw())")
    assert "body_height_m" in page.text_content("#reason")
    page.evaluate("(state.body_height_m = 1.79, draw())")
