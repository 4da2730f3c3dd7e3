"""The package from its wheel: without the checkout, without a compiler, in any folder."""

import ast
import os
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

from saddlewalk.paths import CHECKOUT
from sanitizer import WITHOUT

PIP = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet"]
TOOLS = f"{Path(sys.executable).parent}:{os.environ['PATH']}"


def run(*words: str | Path, **options) -> subprocess.CompletedProcess:
    done = subprocess.run(words, capture_output=True, text=True, check=False, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    build = [*PIP, "wheel", "--no-deps", "--no-build-isolation", "-w", folder, CHECKOUT]
    run(*build, env={**WITHOUT, "PATH": TOOLS})
    (made,) = folder.iterdir()
    return made


@pytest.fixture(scope="module")
def site(wheel) -> Path:
    """A site-packages folder with the wheel and what lays a library beside it."""
    folder = wheel.parent.with_name("site")
    run(*PIP, "install", "--no-deps", "--target", folder, wheel, "lcm==1.5.3", env=WITHOUT)
    return folder


def saddlewalk(site: Path, cwd: Path, *options: str) -> str:
    """Its standard output. Whatever is not Python must come from the wheel: PATH is empty."""
    program = "from saddlewalk.cli import main; raise SystemExit(main())"
    environment = {"PYTHONPATH": str(site), "PATH": "", "HOME": str(cwd)}
    return run(sys.executable, "-c", program, *options, cwd=cwd, env=environment).stdout


def imported_at_once(path: Path) -> set[str]:
    """Packages that a module needs to be imported itself, beside Python's own."""
    statements = ast.parse(path.read_text()).body
    plain = [
        alias.name for line in statements if isinstance(line, ast.Import) for alias in line.names
    ]
    chosen = [line.module or "" for line in statements if isinstance(line, ast.ImportFrom)]
    return {name.split(".")[0] for name in plain + chosen} - sys.stdlib_module_names


def test_modules_need_only_what_is_installed_with_the_package():
    """Those of an extra of their own aside."""
    named = {"can": "python-can", "markdown_it": "markdown-it-py", "saddlewalk": "saddlewalk"}
    required = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())["project"]["dependencies"]
    installed = {requirement.split("==")[0] for requirement in required} | {"saddlewalk"}
    package = CHECKOUT / "host_tools/saddlewalk"
    for path in package.rglob("*.py"):
        if path.parent != package / "physics":
            needed = {named.get(name, name) for name in imported_at_once(path)}
            assert needed <= installed, path


def test_its_platform_is_in_its_name(wheel):
    assert "-py3-none-linux_" in wheel.name


def test_demo_walks_and_its_log_is_reported(site, tmp_path):
    ports = ["--lcm", "udpm://239.255.76.67:7699?ttl=0", "--can", "udp:239.74.163.2:43199"]
    printed = saddlewalk(site, tmp_path, "demo", "--clock", "lockstep", "--duration", "5", *ports)
    assert "the same bits" in printed and "BAD" not in printed
    saddlewalk(site, tmp_path, "report", "out/demo/walk.lcmlog")
    assert (tmp_path / "out/demo/walk.lcmlog.html").stat().st_size > 10_000


def test_plan_is_the_checkout_s_to_the_bit(site, tmp_path, capsys):
    from saddlewalk.cli import main

    assert main(["plan", "--speed", "1.2"]) == 0
    assert saddlewalk(site, tmp_path, "plan", "--speed", "1.2") == capsys.readouterr().out


def test_it_takes_nothing_from_the_checkout(site, tmp_path):
    show = (
        "from saddlewalk import core, paths as p; core.library(); print(p.SHIPPED, core.__file__)"
    )
    done = run(sys.executable, "-c", show, cwd=tmp_path, env={"PYTHONPATH": str(site)})
    package = site / "saddlewalk"
    assert done.stdout.split() == [str(package / "shipped"), str(package / "core.py")]


def test_the_page_comes_with_it(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    assert "saddlewalk/shipped/build/web/uPlot.iife.js" in names
    assert "saddlewalk/view/web/index.html" in names


def test_what_compiles_a_wheel_is_pinned_like_all_else():
    backend = (CHECKOUT / "tools/build_backend.py").read_text()
    lock = (CHECKOUT / "requirements.lock").read_text().split()
    project = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())
    pinned = [line for line in lock if f'"{line}"' in backend]
    assert {line.partition("==")[0] for line in pinned} == {"cantools", "cmake", "lcm", "ninja"}
    assert project["build-system"]["requires"][0] in lock
