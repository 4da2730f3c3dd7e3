"""The files of `make release`, each tried by itself: nothing of the checkout but the tests."""

import hashlib
import json
import re
import shutil
import sys
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu

from builds import arduino_sketch, compile_c, platformio_walk, run
from page import chromium, watched
from saddlewalk import paths

pytestmark = [pytest.mark.release, pytest.mark.timeout(300)]

CHECKOUT = paths.CHECKOUT
RELEASE = CHECKOUT / "build/release"


def one(pattern: str) -> Path:
    (found,) = RELEASE.glob(pattern)
    return found


def unpacked(pattern: str, folder: Path) -> Path:
    """The one folder that an archive has at its top."""
    shutil.unpack_archive(one(pattern), folder / "unpacked")
    (top,) = (folder / "unpacked").iterdir()
    return top


def test_every_file_has_its_checksum():
    lines = (RELEASE / "SHA256SUMS").read_text().splitlines()
    sums = {name: digest for digest, name in map(str.split, lines)}
    assert sums.keys() == {file.name for file in RELEASE.iterdir()} - {"SHA256SUMS"}
    for name, digest in sums.items():
        assert hashlib.sha256((RELEASE / name).read_bytes()).hexdigest() == digest, name


def test_the_wheel_walks_in_an_empty_environment(tmp_path):
    """Its dependencies from the index, in a folder with nothing, by the commands of the README."""
    assert re.search("-py3-none-manylinux_2_[0-9]+_", one("*.whl").name)
    run(sys.executable, "-m", "venv", tmp_path / "venv")
    install = [tmp_path / "venv/bin/pip", "--disable-pip-version-check", "install", "--quiet"]
    run(*install, "-c", CHECKOUT / "requirements.lock", one("*.whl"))
    saddlewalk = tmp_path / "venv/bin/saddlewalk"
    ports = ["--can", "udp:239.74.163.2:43177", "--lcm", "udpm://239.255.76.67:7677?ttl=0"]
    printed = run(saddlewalk, "demo", "--clock", "lockstep", *ports, cwd=tmp_path).stdout
    assert "recovery step" in printed and "BAD" not in printed
    run(saddlewalk, "report", "out/demo/walk.lcmlog", cwd=tmp_path)
    rows = run(saddlewalk, "plan", "--speed", "1.2", cwd=tmp_path).stdout
    assert rows.startswith("t_s,phase,")


@pytest.fixture(scope="module")
def core(tmp_path_factory) -> Path:
    return unpacked("saddlewalk-core-*.tar.gz", tmp_path_factory.mktemp("core"))


@pytest.fixture(scope="module")
def walk(core) -> str:
    """What the example in the core's archive prints, built as the README says."""
    flags = ["-O2", "-ffp-contract=off", f"-I{core / 'include'}"]
    compile_c(core / "minimal", *flags, core / "minimal.c", core / "saddlewalk.c")
    printed = run(core / "minimal").stdout
    assert printed.count("XCoM in base") == 50
    return printed


def test_the_core_has_the_bits_of_every_target(core, tmp_path):
    tests, wire = CHECKOUT / "tests/targets", CHECKOUT / "firmware/wire"
    joints = CHECKOUT / "firmware/joints"
    version = re.match(r'VERSION "(\d+)"', (wire / "saddlewalk.dbc").read_text())[1]
    folders = [core, core / "include", wire / "include", joints / "include"]
    folders.append(paths.built("firmware/wire/signals"))
    compile_c(
        tmp_path / "same_bits",
        *("-std=c99", "-O2", "-ffp-contract=off", "-DSADDLE_ONE_FILE"),
        *(f"-DSADDLE_WIRE_VERSION={version}", *(f"-I{folder}" for folder in folders)),
        *(tests / f"{name}.c" for name in ("same_bits", "elementary", "sequences")),
        *sorted((wire / "src").glob("*.c")),
    )
    assert run(tmp_path / "same_bits").stdout == (tests / "same_bits.txt").read_text()


def test_the_platformio_library_gives_the_core_s_walk(walk, tmp_path):
    assert platformio_walk(unpacked("saddlewalk-platformio-*.tar.gz", tmp_path), tmp_path) == walk


def test_the_arduino_library_runs_its_example(tmp_path):
    library = unpacked("saddlewalk-arduino-*.zip", tmp_path)
    assert arduino_sketch(library, tmp_path)[-1] == "1.014 m, level 1"


def test_the_fmu_is_valid_and_walks():
    fmu = str(one("*.fmu"))
    assert validate_fmu(fmu) == []
    start = {"command.mode": 1, "command.speed_m_s": 1.2}
    every = {"stop_time": 8, "output_interval": 0.08, "output": ["plan.speed_m_s"]}
    rows = fmpy.simulate_fmu(fmu, start_values=start, **every)
    assert rows["plan.speed_m_s"][-1] == pytest.approx(1.2)


@pytest.fixture(scope="module")
def page():
    with chromium() as browser, watched(browser, "file:") as page:
        yield page


def test_the_playground_opens_from_its_file_and_judges(page):
    page.goto(one("saddlewalk-playground-*.html").as_uri())
    assert page.text_content("#level") == "stable"


def test_the_site_opens_from_its_files(page, tmp_path):
    site = unpacked("saddlewalk-site-*.tar.gz", tmp_path)
    for name in ("index", "equations", "reference-c-core"):
        page.goto((site / f"{name}.html").as_uri())
        assert "Saddlewalk" in page.title()


def test_the_sbom_has_what_is_contained_and_what_is_installed():
    bom = json.loads((RELEASE / "sbom.cdx.json").read_text())
    required = {each["name"] for each in bom["components"] if each["scope"] == "required"}
    assert required > {"uPlot", "FMI headers", "numpy", "lcm", "websockets", "cffi", "pycparser"}
    assert not required & {"pytest", "ruff", "mujoco-core"}
    purls = [each["purl"] for each in bom["components"]]
    assert len(purls) == len(set(purls))
    page = paths.built("web/uPlot.iife.js").read_text()
    (charts,) = (each["version"] for each in bom["components"] if each["name"] == "uPlot")
    assert f"(v{charts})" in page[:500]


def test_the_changes_are_those_of_the_version():
    version = one("*.whl").name.split("-")[1]
    changes = (RELEASE / "CHANGES.md").read_text()
    assert changes.startswith((f"## {version} (", "## Unreleased\n"))  # the latter in a trial
