"""The humanoid of dm_control (Tassa et al. 2018), a body that nobody of this project designed.

Its XML comes from the package `playground` on PyPI (Apache-2.0). That is downloaded once, checked
and kept in the build folder; nothing of it is installed, run or in this project's source.
"""

import functools
import hashlib
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from saddlewalk.contract import SIDES
from saddlewalk.errors import UserError
from saddlewalk.paths import build_dir
from saddlewalk.physics.body import WALK_FIELDS, Body, Leg, compiled, contact

PACKAGE = "playground==0.2.0"
XML = "mujoco_playground/_src/dm_control_suite/xmls/humanoid.xml"
SHA256 = "53ed3001f0f9fdbb7f32ac7e03471486af7daf62df23f3670fea71bfef4d857a"
INCLUDED = ("skybox", "visual", "materials")  # looks, of which only the names are needed here

# Joint -> greatest torque in N m. Its own motors are too weak to walk like a person.
TORQUES: Mapping[str, float] = {
    "hip_x": 120.0,
    "hip_z": 80.0,
    "hip_y": 160.0,
    "knee": 160.0,
    "ankle_y": 100.0,
    "ankle_x": 50.0,
}
# Degrees. As published a leg adducts by 5 degrees and extends by 20, too little for a step.
WIDER = {"hip_x": (-45.0, 45.0), "hip_y": (-110.0, 50.0)}
# Four points at the ends of the left foot's two capsules, the toe first.
SOLE_M = np.array([(0.14, 0.04, 0.0), (0.14, -0.02, 0.0), (-0.07, 0.02, 0.0), (-0.07, 0.0, 0.0)])
SOLE_RADIUS_M = 0.027
PENDULUM_RATIO = 0.51  # of the height: knees a little bent
STEP_WIDTH_M = 0.16
SOLE_HALF_WIDTH_M = 0.025  # within which the CoP is kept
LANDED_EARLY_N = 150.0  # a round sole bounces off at less


def dm_control() -> Body:
    """Legs free, all else welded. Raises UserError if its XML cannot be had."""
    spec = mujoco.MjSpec.from_string(humanoid_xml(), include=_looks())
    torques = {f"{side}_{name}": torque for side in SIDES for name, torque in TORQUES.items()}
    for joint in list(spec.joints):
        if joint.type == mujoco.mjtJoint.mjJNT_HINGE and joint.name not in torques:
            spec.delete(joint)
        for name, limits in WIDER.items():
            if joint.name.endswith(name):
                joint.range = limits
    for part in (*spec.sensors, *spec.actuators):
        spec.delete(part)
    for geom in spec.geoms:  # only the feet touch, and only the floor
        if geom.name == "floor":
            _set(geom, contact(2, 1))
        elif geom.name.endswith("_foot"):
            _set(geom, contact(1, 2))
        else:
            geom.contype = geom.conaffinity = 0
    legs = tuple(_leg(side) for side in SIDES)
    model = compiled(spec, torques)
    pair = (legs[0], legs[1])
    return Body("dm_control", model, "pelvis", pair, -1.0, SOLE_HALF_WIDTH_M, LANDED_EARLY_N)


@functools.cache
def fields() -> Mapping[str, float | int]:
    """Fields of saddle_config_t. Its soles are narrow, so it stands and steps with close feet."""
    model = dm_control().model
    return {
        **WALK_FIELDS,
        "body_height_m": _height_m(model),
        "body_mass_kg": float(model.body_mass.sum()),
        "pendulum_ratio": PENDULUM_RATIO,
        "step_width_slow_m": STEP_WIDTH_M,
        "step_width_fast_m": STEP_WIDTH_M,
    }


def _set(geom: Any, values: Mapping[str, Any]) -> None:
    for name, value in values.items():
        setattr(geom, name, value)


def _leg(side: str) -> Leg:
    mirrored = 1 if side == "left" else -1
    corners_m = SOLE_M * (1, mirrored, 1) - (0, 0, SOLE_RADIUS_M)
    return Leg(f"{side}_foot", f"{side}_knee", corners_m)


def _height_m(model: Any) -> float:
    """From the soles to the top of the head with straight legs, as the model is drawn."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    head, foot = model.geom("head"), data.body("left_foot")
    top = data.geom("head").xpos[2] + head.size[0]
    return float(top - (foot.xpos[2] - SOLE_RADIUS_M))


def _looks() -> dict[str, bytes]:
    """Stand-ins for the files of colours that the XML includes."""
    looks = {"materials": '<material name="self"/><material name="grid"/>'}
    return {
        f"common/{name}.xml": f"<mujoco><asset>{looks.get(name, '')}</asset></mujoco>".encode()
        for name in INCLUDED
    }


@functools.cache
def humanoid_xml() -> str:
    """From the build folder, or downloaded to it."""
    path = build_dir() / "dm_control" / "humanoid.xml"
    if not path.exists():
        content = _download()
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    content = path.read_bytes()
    found = hashlib.sha256(content).hexdigest()
    if found != SHA256:
        raise UserError(f"{path} is not that of {PACKAGE}: sha256 {found}: delete it and try again")
    return content.decode()


def _download() -> bytes:
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet", "download"]
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [*pip, "--no-deps", "--only-binary", ":all:", "-d", folder, PACKAGE],
            capture_output=True,
            text=True,
        )
        if done.returncode != 0:
            last = (done.stderr.strip().splitlines() or [f"status {done.returncode}"])[-1]
            raise UserError(
                f"--body dm_control: pip cannot download {PACKAGE}, which has its XML: {last}"
            )
        (wheel,) = Path(folder).glob("*.whl")
        with zipfile.ZipFile(wheel) as archive:
            return archive.read(XML)
