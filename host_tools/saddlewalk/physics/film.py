"""A film of a body's walk, drawn by MuJoCo without a display."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from PIL import Image

from saddlewalk.errors import UserError
from saddlewalk.physics.poses import Pose

WIDTH, HEIGHT = 640, 400
SHAPES_MAX = 500
DISTANCE_M, AZIMUTH_DEG, ELEVATION_DEG = 3.6, 110.0, -8.0
MISSING = "--film needs EGL: as root, apt-get install -y libegl1 libgl1-mesa-dri"


class Camera:
    """Draws poses of a model from its side. Raises UserError where there is no EGL."""

    def __init__(self, model: Any) -> None:
        try:
            from mujoco.egl import GLContext

            self._screen = GLContext(WIDTH, HEIGHT)
            self._screen.make_current()
        except (ImportError, AttributeError, OSError, RuntimeError) as error:
            raise UserError(MISSING) from error
        model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH, HEIGHT
        self._model, self._data = model, mujoco.MjData(model)
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._scene = mujoco.MjvScene(model, SHAPES_MAX)
        for effect in (mujoco.mjtRndFlag.mjRND_SHADOW, mujoco.mjtRndFlag.mjRND_REFLECTION):
            self._scene.flags[effect] = 0
        self._options, self._view = mujoco.MjvOption(), mujoco.MjvCamera()
        self._view.distance = DISTANCE_M
        self._view.azimuth, self._view.elevation = AZIMUTH_DEG, ELEVATION_DEG

    def picture(self, pose: Pose) -> np.ndarray:
        """(HEIGHT, WIDTH, 3) of 8 bits."""
        model, data = self._model, self._data
        data.qpos[:] = pose.qpos
        mujoco.mj_forward(model, data)
        self._view.lookat[:] = (data.subtree_com[0][0], 0.0, 0.9)
        everything = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(
            model, data, self._options, None, self._view, everything, self._scene
        )
        frame = mujoco.MjrRect(0, 0, WIDTH, HEIGHT)
        mujoco.mjr_render(frame, self._scene, self._context)
        pixels = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
        mujoco.mjr_readPixels(pixels, None, frame, self._context)
        return pixels[::-1]

    def close(self) -> None:
        self._context.free()
        self._screen.free()


def film(path: Path, camera: Camera, poses: Sequence[Pose]) -> None:
    """An animated GIF in real time."""
    pictures = _pictures(camera, poses)
    step_ms = round(1000 * (poses[1].time_s - poses[0].time_s)) if len(poses) > 1 else 1000
    next(pictures).save(
        path, save_all=True, append_images=pictures, duration=step_ms, loop=0, format="GIF"
    )


def _pictures(camera: Camera, poses: Sequence[Pose]) -> Iterator[Image.Image]:
    for pose in poses:
        yield Image.fromarray(camera.picture(pose)).quantize(64)
