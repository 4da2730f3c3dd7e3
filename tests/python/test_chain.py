"""The whole chain: a body's sensors by CAN to the firmware, its joint commands by CAN back."""

import importlib.util
import re

import numpy as np
import pytest

from saddlewalk.cli import main

pytestmark = [
    pytest.mark.firmware,
    pytest.mark.skipif(
        importlib.util.find_spec("mujoco") is None or importlib.util.find_spec("piqp") is None,
        reason="MuJoCo is missing: run `make physics`",
    ),
]


def test_a_body_on_can_walks_and_stops(capsys):
    assert main(["chain", "--distance", "1", "--rate", "250"]) == 0
    printed = capsys.readouterr().out
    distance_m = float(re.match(r"host: ([\d.]+) m in", printed)[1])
    assert 1.0 < distance_m < 2.0
    assert "stands at the end" in printed
    assert "0 with the fallback, 0 with a fault of the sensors" in printed


def test_a_fall_is_told(monkeypatch, capsys):
    """Of a body whose drives do nothing."""
    idle = lambda plant, _: np.zeros(plant.model.nu)  # noqa: E731
    monkeypatch.setattr("saddlewalk.physics.joint_chain.drive_torques", idle)
    assert main(["chain", "--distance", "1", "--rate", "250"]) == 1
    assert re.search(r"m in [\d.]+ s, fell at [\d.]+ s", capsys.readouterr().out)


@pytest.mark.targets
def test_host_and_cortex_m4_send_the_same_bits(monkeypatch, capsys):
    """While standing and in the first step: one in 250 passes of the figure in docs/joints.md."""
    monkeypatch.setattr("saddlewalk.physics.joint_chain.STOPPING_S", 0.2)
    monkeypatch.setattr("saddlewalk.physics.joint_chain.STARTS_AND_STOPS_S", 0.1)
    main(["chain", "--distance", "1", "--rate", "250", "--speed", "1", "--firmware", "both"])
    printed = capsys.readouterr().out
    assert printed.endswith("bits of both: equal\n")
    assert "0 lost, 0 not sent" in printed
