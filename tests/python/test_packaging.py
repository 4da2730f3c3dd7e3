"""The library builds in other build systems, by their manifests, and rejects flags that change
bits.
"""

import json
import platform
import re
import runpy
from pathlib import Path

import can
import kconfiglib
import pytest
import yaml

from builds import CONSUMERS, PROGRAM, arduino_sketch, cached, compile_c, cpp, platformio_walk, run
from saddlewalk import paths
from saddlewalk.transport.wire import Receiver

CHECKOUT = paths.CHECKOUT
CORE = CHECKOUT / "firmware/core"
PACKAGE = runpy.run_path(str(CHECKOUT / "tools/package.py"))
VERSION = PACKAGE["version"]()
ERROR_BUILD = 6


def configure(consumer: str, folder: Path, check: bool = True, **variables: str | Path):
    same = ("CMAKE_C_COMPILER", "CMAKE_C_FLAGS", "CMAKE_MAKE_PROGRAM", "Python3_EXECUTABLE")
    variables |= {name: cached(name) for name in same} | {"PROGRAM": PROGRAM}
    options = [f"-D{name}={value}" for name, value in variables.items()]
    source = CONSUMERS / consumer
    cmake = cached("CMAKE_COMMAND")
    return run(cmake, "-S", source, "-B", folder, "-G", "Ninja", *options, check=check)


def walk_of(consumer: str, folder: Path, **variables: str | Path) -> str:
    """What the README's program prints, built by that consumer."""
    configure(consumer, folder, **variables)
    run(cached("CMAKE_COMMAND"), "--build", folder, "-j2")
    return run(folder / "walk").stdout


@pytest.fixture(scope="module")
def walk(tmp_path_factory) -> str:
    """Output of the README's program, built as described there."""
    program = tmp_path_factory.mktemp("plain") / "walk"
    flags = ["-Ifirmware/core/include", "-ffp-contract=off"]
    readme = " ".join((CHECKOUT / "README.md").read_text().split())
    assert f"with `{' '.join(flags)}`" in readme
    one_file = program.with_suffix(".c")
    run(CHECKOUT / "tools/amalgamate.py", one_file)
    compile_c(program, f"-I{CORE / 'include'}", flags[1], PROGRAM, one_file)
    printed = run(program).stdout
    assert printed.count("\n") == 50
    return printed


@pytest.mark.parametrize("library", ["core", "joints"])
def test_the_one_file_core_exports_only_its_interface(library):
    archive = paths.built(f"lib/libsaddlewalk_{library}.a")
    listing = run(cached("CMAKE_NM"), "-g", "--defined-only", archive)
    exported = {line.split()[2] for line in listing.stdout.splitlines() if " T " in line}
    assert exported == runpy.run_path(str(CHECKOUT / "tools/amalgamate.py"))["interface"](library)


def test_two_modules_with_one_name_are_rejected_in_one_file(tmp_path):
    amalgamate = runpy.run_path(str(CHECKOUT / "tools/amalgamate.py"))
    paths = [tmp_path / "a.c", tmp_path / "b.c"]
    for path in paths:
        path.write_text("static float sum(float a)\n{\n    return a;\n}\n")
    assert amalgamate["same_names"](paths) == ["sum is in a.c and in b.c"]


def test_the_one_file_core_marks_what_a_compiler_may_inline():
    text = runpy.run_path(str(CHECKOUT / "tools/amalgamate.py"))["amalgamation"]()
    assert "\nstatic inline void saddle_cycle_pose(" in text
    assert "\nstatic float saddle_exp(" in text
    assert "\nstatic SADDLE_NOINLINE uint32_t saddle_cycle_advance(" in text


@pytest.fixture(scope="module")
def installed(tmp_path_factory) -> Path:
    prefix = tmp_path_factory.mktemp("installed")
    run(cached("CMAKE_COMMAND"), "--install", paths.build_dir(), "--prefix", prefix)
    return prefix


def test_find_package_gives_core_wire_and_joints(installed, walk, tmp_path):
    found = {"CMAKE_PREFIX_PATH": installed, "WANTED": VERSION}
    assert walk_of("find_package", tmp_path, **found) == walk
    receiver = Receiver()
    lines = run(tmp_path / "frames").stdout.splitlines()
    for line in lines:
        identifier, data = line.split("#")
        message = can.Message(
            arbitration_id=int(identifier, 16), data=bytes.fromhex(data), is_extended_id=False
        )
        assert receiver.accept(message), line
    assert len(lines) > 15
    valid, knee_rad = run(tmp_path / "squat").stdout.split()
    assert valid == "1" and 1.0 < float(knee_rad) < 2.0


def test_the_wire_builds_without_cmake_to_the_same_frames(installed, tmp_path):
    """As docs/porting.md describes it for any other build."""
    configure("find_package", tmp_path, CMAKE_PREFIX_PATH=installed, WANTED=VERSION)
    run(cached("CMAKE_COMMAND"), "--build", tmp_path, "-j2")
    wire, dbc = CHECKOUT / "firmware/wire", CHECKOUT / "firmware/wire/saddlewalk.dbc"
    generator = CHECKOUT / "tools/wire_signals.py"
    run(cached("Python3_EXECUTABLE"), generator, dbc, tmp_path / "wire_signals.h")
    rooms = [CHECKOUT / "firmware" / room / "include" for room in ("core", "joints", "wire")]
    include = [f"-I{folder}" for folder in (*rooms, tmp_path)]
    version = re.match(r'VERSION "(\d+)"', dbc.read_text())[1]
    flags = ["-ffp-contract=off", f"-DSADDLE_WIRE_VERSION={version}"]
    run(CHECKOUT / "tools/amalgamate.py", tmp_path / "core.c")
    sources = [CONSUMERS / "frames.c", tmp_path / "core.c", *(wire / "src").glob("*.c")]
    compile_c(tmp_path / "plain", *include, *flags, *sources)
    assert run(tmp_path / "plain").stdout == run(tmp_path / "frames").stdout


def test_find_package_rejects_another_version(installed, tmp_path):
    found = {"CMAKE_PREFIX_PATH": installed, "WANTED": "99.0"}
    result = configure("find_package", tmp_path, check=False, **found)
    assert result.returncode != 0
    assert f"version: {VERSION}" in result.stderr


def test_installed_files_do_not_name_the_checkout(installed):
    for file in installed.rglob("*.cmake"):
        assert str(CHECKOUT) not in file.read_text(), file


@pytest.mark.parametrize("folder", [".", "firmware/core"])
def test_add_subdirectory(folder, walk, tmp_path):
    taken = {"FOLDER": CHECKOUT / folder}
    assert walk_of("add_subdirectory", tmp_path, **taken) == walk


def test_headers_from_cpp(tmp_path):
    rooms = ("core", "joints", "wire")
    include = [f"-I{CHECKOUT / 'firmware' / room / 'include'}" for room in rooms]
    source, compiled = tmp_path / "use.cpp", tmp_path / "use.o"
    source.write_text("#include <saddlewalk/wire_joints.h>\nint main() { saddle_tick(0, 0, 0); }\n")
    run(*cpp(), *include, "-c", source, "-o", compiled)
    compile_c(
        tmp_path / "use",
        compiled,
        paths.built("lib/libsaddlewalk_core.a"),
        *cached("CMAKE_C_FLAGS").split(),
    )


def test_arduino_library_builds_as_arduino_does_it(tmp_path):
    run(CHECKOUT / "tools/package.py", "arduino", tmp_path / "Saddlewalk")
    printed = arduino_sketch(tmp_path / "Saddlewalk", tmp_path)
    assert len(printed) == 10
    assert printed[-1] == "1.014 m, level 1"


def test_arduino_properties_are_complete(tmp_path):
    run(CHECKOUT / "tools/package.py", "arduino", tmp_path / "Saddlewalk")
    lines = (tmp_path / "Saddlewalk/library.properties").read_text().splitlines()
    fields = dict(line.split("=", 1) for line in lines)
    expected = "name version author maintainer sentence paragraph category architectures includes"
    assert all(fields[name] for name in expected.split())
    assert re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9 _.-]*", fields["name"])
    assert fields["version"] == VERSION
    assert fields["category"] in ("Device Control", "Data Processing", "Sensors", "Other")
    assert (tmp_path / "Saddlewalk/src" / fields["includes"]).is_file()
    rejected = run(CHECKOUT / "tools/package.py", "arduino", tmp_path, check=False)
    assert rejected.returncode == 1
    assert rejected.stderr == f"{tmp_path} exists already: name a new folder\n"


def test_platformio_manifest_is_current_and_builds(walk, tmp_path):
    committed = (CHECKOUT / "library.json").read_text()
    manifest = json.loads(committed)
    old = tmp_path / "library.json"
    old.write_text(committed.replace(f'"version": "{VERSION}"', '"version": "0.0.0"'))
    assert json.loads(old.read_text())["version"] == "0.0.0"
    PACKAGE["platformio"](old)
    assert old.read_text() == committed

    assert re.fullmatch(r"[a-z0-9-]{1,50}", manifest["name"])
    assert len(manifest["description"]) <= 255
    assert (CHECKOUT / manifest["build"]["includeDir"] / manifest["headers"]).is_file()
    assert all((CHECKOUT / path).exists() for path in manifest["export"]["include"])
    assert platformio_walk(CHECKOUT, tmp_path) == walk


def test_zephyr_module_builds_under_stand_ins_for_its_functions(walk, tmp_path):
    module = yaml.safe_load((CHECKOUT / "zephyr/module.yml").read_text())
    assert module["name"] == "saddlewalk"
    folders = {
        "MODULE": CHECKOUT / module["build"]["cmake"],
        "SAMPLE": CHECKOUT / "examples/zephyr",
    }
    assert walk_of("zephyr", tmp_path, **folders) == walk
    readme = (CHECKOUT / "examples/zephyr/README.md").read_text()
    assert run(tmp_path / "sample").stdout == re.search(r"```text\n(.*?)```", readme, re.DOTALL)[1]


@pytest.mark.parametrize("has_fpu", ["y", "n"])
def test_zephyr_option_is_off_by_default_and_selects_the_fpu(has_fpu, tmp_path):
    module = yaml.safe_load((CHECKOUT / "zephyr/module.yml").read_text())
    tree = tmp_path / "Kconfig"
    options = f"config CPU_HAS_FPU\n\tdef_bool {has_fpu}\n\nconfig FPU\n\tbool\n\n"
    tree.write_text(f'{options}source "{CHECKOUT / module["build"]["kconfig"]}"\n')
    config = kconfiglib.Kconfig(str(tree))
    assert not config.warnings
    assert config.syms["SADDLEWALK"].str_value == "n"
    config.syms["SADDLEWALK"].set_value("y")
    assert config.syms["FPU"].str_value == has_fpu


CHECK = """
#include "math/rounding.h"
int main(void) { return saddle_rounds_as_written() ? 0 : 6; }
"""
INIT = """
#include <saddlewalk/saddlewalk.h>
int main(void)
{
    static saddle_context_t walker;
    const saddle_config_t config = saddle_config_default(1.79f, 63.3f);
    return (int)saddle_init(&walker, &config);
}
"""


def outcome(tmp_path: Path, program: str, sources: list[Path], *flags: str) -> int | str:
    """The program's exit status, or what the compiler said."""
    (tmp_path / "main.c").write_text(program)
    arguments = [
        f"-I{CORE / 'include'}",
        f"-I{CORE / 'src'}",
        "-O2",
        *flags,
        tmp_path / "main.c",
        *sources,
    ]
    compiled = compile_c(tmp_path / "main", *arguments, check=False)
    return compiled.stderr or run(tmp_path / "main", check=False).returncode


@pytest.mark.parametrize(
    "flags",
    [
        "-ffast-math",
        "-funsafe-math-optimizations",
        "-fassociative-math -fno-signed-zeros -fno-trapping-math",
        "-freciprocal-math",
        "-ffinite-math-only",
        pytest.param(
            "-m32 -mno-sse",
            marks=pytest.mark.skipif(platform.machine() != "x86_64", reason="the x87 is an x86's"),
        ),
    ],
)
def test_flags_that_change_results_are_rejected(flags, tmp_path):
    got = outcome(
        tmp_path, CHECK, [CORE / "src/math/rounding.c"], "-ffp-contract=off", *flags.split()
    )
    assert got == ERROR_BUILD or re.search("error: .*Saddlewalk: ", str(got))


def test_a_contracted_multiply_add_is_rejected_by_init(tmp_path):
    fused = ["-mfma"] if platform.machine() == "x86_64" else []
    if fused and " fma " not in Path("/proc/cpuinfo").read_text():
        pytest.skip("this processor has no fused multiply-add")
    sources = list((CORE / "src").rglob("*.c"))
    assert outcome(tmp_path, INIT, sources, *fused, "-ffp-contract=fast") == ERROR_BUILD
