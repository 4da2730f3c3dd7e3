"""The FMU: FMPy's validation; the walk of `saddlewalk plan` and the core's ticks to the bit."""

import ctypes
import math
import shutil
import subprocess
import zipfile
from pathlib import Path
from types import SimpleNamespace

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu

from saddlewalk.cli import main
from saddlewalk.config import configuration
from saddlewalk.core import Command, Core, Measurement, ffi
from saddlewalk.paths import built
from saddlewalk.planning.steady import COLUMNS, row_of
from saddlewalk.table import format_cell

TICK_S = 0.08


@pytest.fixture(scope="module")
def fmu() -> Path:
    return built("saddlewalk.fmu")


@pytest.fixture(scope="module")
def unpacked(fmu, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("fmu")
    zipfile.ZipFile(fmu).extractall(folder)
    return folder


class Slave:
    """An instance whose variables are set and read by name."""

    def __init__(self, folder: Path) -> None:
        described = fmpy.read_model_description(str(folder))
        self.variables = {v.name: v for v in described.modelVariables}
        self.slave = FMU2Slave(
            guid=described.guid,
            unzipDirectory=str(folder),
            modelIdentifier=described.coSimulation.modelIdentifier,
            instanceName="walker",
        )
        self.slave.instantiate()
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()

    def set(self, values: dict[str, float]) -> None:
        for name, value in values.items():
            variable = self.variables[name]
            getattr(self.slave, f"set{variable.type}")([variable.valueReference], [value])

    def __getitem__(self, name: str) -> float:
        variable = self.variables[name]
        return getattr(self.slave, f"get{variable.type}")([variable.valueReference])[0]

    def outputs(self) -> dict[str, float]:
        return {name: self[name] for name, v in self.variables.items() if v.causality == "output"}


@pytest.fixture
def slave(unpacked):
    created = Slave(unpacked)
    yield created
    created.slave.freeInstance()


def test_fmpy_has_nothing_to_complain_about(fmu):
    assert validate_fmu(str(fmu)) == []


def test_each_number_of_the_configuration_and_the_output_is_a_variable(slave):
    names = set(slave.variables)
    config = {f"config.{name}" for name, _ in ffi().typeof("saddle_config_t").fields}
    assert config | {"plan.com_m.x", "verdict.recovery.landing_m.y", "walk.ripple"} < names
    assert slave.variables["plan.com_velocity_m_s.x"].unit == "m/s"
    assert slave.variables["config.body_mass_kg"].start == "63.2999992"
    assert len(slave.outputs()) > 100


def nested(values: dict[str, float]) -> SimpleNamespace:
    """Members with dots as attributes; foot_m[0] and [1] as a list."""
    tree = SimpleNamespace()
    for name, value in values.items():
        *path, last = name.replace("[0]", ".0").replace("[1]", ".1").split(".")
        node = tree
        for part in path:
            node.__dict__.setdefault(part, SimpleNamespace())
            node = node.__dict__[part]
        node.__dict__[last] = value
    return tree


def fmu_row(t_s: float, row) -> list[str]:
    tree = nested({name: row[name].item() for name in row.dtype.names})
    feet = tree.plan.foot_m.__dict__
    tree.plan.foot_m = [feet["0"], feet["1"]]
    return [format_cell(cell) for cell in row_of(t_s, tree.plan, tree.planned)]


@pytest.mark.parametrize(
    ("speed", "angle", "ankle", "dt_s", "height"),
    [(1.2, 10, 0, 0.08, 1.79), (0.7, 5, 2, 0.02, 1.6), (1.6, 15, 1, 0.16, 1.9)],
)
def test_a_walk_is_that_of_saddlewalk_plan_to_the_bit(
    fmu, capsys, speed, angle, ankle, dt_s, height
):
    name = ("erf", "rigid", "cycloid")[ankle]
    options = ["--speed", str(speed), "--hs-angle", str(angle), "--ankle", name, "--dt", str(dt_s)]
    assert main(["plan", *options, "--height", str(height), "--strides", "3"]) == 0
    header, *lines = capsys.readouterr().out.splitlines()
    assert header.split(",") == COLUMNS and len(lines) > 15
    described = fmpy.read_model_description(str(fmu))
    outputs = [v.name for v in described.modelVariables if v.name.startswith("plan")]
    start = {
        "steady_start": True,
        "config.ankle": ankle,
        "config.body_height_m": height,
        "command.mode": 1,
        "command.speed_m_s": speed,
        "command.heel_strike_rad": math.radians(angle),
    }
    rows = fmpy.simulate_fmu(
        str(fmu),
        stop_time=(len(lines) - 1) * dt_s,
        output_interval=dt_s,
        start_values=start,
        output=outputs,
    )
    assert len(rows) == len(lines)
    for number, (row, line) in enumerate(zip(rows, lines, strict=True)):
        assert ",".join(fmu_row(number * dt_s, row)) == line


def read(path: str, struct) -> float:
    """A member of a cffi struct by the name of the FMU's variable."""
    for part in path.replace("[", ".[").split("."):
        struct = struct[int(part[1:-1])] if part.startswith("[") else getattr(struct, part)
    return struct


def swaying(tick: int) -> Measurement:
    """Somebody who stands and leans further and further; once the CoM is not measured."""
    return Measurement(
        com_height_m=None if tick == 20 else 0.98,
        com_velocity_m_s=(0.02 * tick, 0.01 * tick),
        left_cop_m=(-0.01 * tick, 0.1),
        right_cop_m=(-0.01 * tick, -0.1),
        left_contact=True,
        right_contact=tick % 3 > 0,
    )


def inputs_of(measurement: Measurement) -> dict[str, float]:
    seen = measurement.com_height_m is not None
    return {
        "measurement.com.age_us": 0 if seen else 2**32 - 1,
        "measurement.com.height_m": measurement.com_height_m or 0.0,
        "measurement.com.velocity_m_s.x": measurement.com_velocity_m_s[0],
        "measurement.com.velocity_m_s.y": measurement.com_velocity_m_s[1],
        "measurement.foot[0].cop_m.x": measurement.left_cop_m[0],
        "measurement.foot[0].cop_m.y": measurement.left_cop_m[1],
        "measurement.foot[0].contact": measurement.left_contact,
        "measurement.foot[0].age_us": 0,
        "measurement.foot[1].cop_m.x": measurement.right_cop_m[0],
        "measurement.foot[1].cop_m.y": measurement.right_cop_m[1],
        "measurement.foot[1].contact": measurement.right_contact,
        "measurement.foot[1].age_us": 0,
    }


def test_measured_ticks_are_the_core_s_to_the_bit(slave):
    core = Core(configuration({}))
    slave.set({"command.mode": 1, "command.speed_m_s": 1.0, "command.heel_strike_rad": 0.1})
    slave.set(inputs_of(swaying(0)))
    slave.slave.exitInitializationMode()
    levels = set()
    for tick in range(40):
        if tick:
            slave.set(inputs_of(swaying(tick)))
            slave.slave.doStep((tick - 1) * TICK_S, TICK_S)
        output = core.tick(tick * 80000, Command(1.0, 0.1), swaying(tick))
        planned = core.score_plan(output.plan)
        for name, value in slave.outputs().items():
            head, _, rest = name.partition(".")
            expected = read(rest, planned) if head == "planned" else read(name, output)
            assert value == expected, (tick, name)
        levels.add(slave["verdict.level"])
    assert len(levels) >= 3


def test_a_saved_state_goes_on_as_it_would_have(slave):
    slave.set({"command.mode": 1, "command.speed_m_s": 1.0})
    slave.slave.exitInitializationMode()
    slave.slave.doStep(0.0, 3.0)
    state = slave.slave.getFMUstate()
    image = slave.slave.serializeFMUstate(state)
    slave.slave.doStep(3.0, 1.0)
    walked = slave.outputs()
    for saved in (state, slave.slave.deSerializeFMUstate(image)):
        slave.slave.setFMUstate(saved)
        assert slave.outputs() != walked
        slave.slave.doStep(3.0, 1.0)
        assert slave.outputs() == walked
        slave.slave.freeFMUstate(saved)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"config.body_height_m": 0.0}, "config.body_height_m"),
        ({"steady_start": True}, "command.mode"),
        ({"command.mode": -1}, "out of its type's range"),
        ({"measurement.foot[0].age_us": math.nan}, "out of its type's range"),
    ],
)
def test_what_cannot_be_is_an_error_that_says_why(slave, capfd, values, said):
    with pytest.raises(FMICallException):
        slave.set(values)
        slave.slave.exitInitializationMode()
    assert said in capfd.readouterr().out


def test_parameters_and_outputs_are_not_set_while_it_walks(slave):
    slave.slave.exitInitializationMode()
    for name in ("config.body_height_m", "plan.speed_m_s"):
        with pytest.raises(FMICallException):
            slave.set({name: 1.0})
    with pytest.raises(FMICallException):
        slave.slave.doStep(0.0, -1.0)


def test_another_description_s_guid_is_rejected(unpacked):
    described = fmpy.read_model_description(str(unpacked))
    arguments = {"unzipDirectory": str(unpacked), "modelIdentifier": "saddlewalk"}
    with pytest.raises(Exception, match="instantiate"):
        FMU2Slave(guid=described.guid[::-1], instanceName="other", **arguments).instantiate()


def test_it_exports_fmi_alone(unpacked):
    (library,) = unpacked.glob("binaries/*/saddlewalk.*")
    loaded = ctypes.CDLL(str(library))
    assert hasattr(loaded, "fmi2DoStep") and not hasattr(loaded, "saddle_tick")


def test_its_sources_build_to_the_same_walk(unpacked, slave, tmp_path):
    sources = unpacked / "sources"
    (shipped,) = unpacked.glob("binaries/*/saddlewalk.*")
    own = tmp_path / shipped.relative_to(unpacked)
    own.parent.mkdir(parents=True)
    flags = ["-shared", "-fPIC", "-O1", "-ffp-contract=off", f"-I{sources}", "-o", own]
    subprocess.run(["cc", *flags, *sources.glob("*.c"), "-lm"], check=True)
    shutil.copy(unpacked / "modelDescription.xml", tmp_path)
    rebuilt = Slave(tmp_path)
    for walker in (slave, rebuilt):
        walker.set({"command.mode": 1, "command.speed_m_s": 1.3})
        walker.slave.exitInitializationMode()
        walker.slave.doStep(0.0, 5.0)
    assert rebuilt.outputs() == slave.outputs()
    rebuilt.slave.freeInstance()
