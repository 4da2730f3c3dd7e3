"""The bodies that can be chosen by name."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from saddlewalk.physics import dm_control
from saddlewalk.physics.body import WINTER_FIELDS, Body, winter


@dataclass(frozen=True)
class BodyMaker:
    fields: Callable[[], Mapping[str, float | int]]  # of saddle_config_t, that the body needs
    make: Callable[[Any], Body]  # for a saddle_config_t


BODIES: Mapping[str, BodyMaker] = {
    "winter": BodyMaker(
        lambda: WINTER_FIELDS, lambda config: winter(config.body_height_m, config.body_mass_kg)
    ),
    "dm_control": BodyMaker(dm_control.fields, lambda _: dm_control.dm_control()),
}
