"""What the tests share."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot.design import Design, load_design
from hyperleg_design.robot.mass.inertials import inertials
from hyperleg_design.robot.motors import catalogue

# the same examples every time, and no clock
settings.register_profile(
    "suite",
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)
settings.load_profile("suite")


FIRST = "test_study.py"
"""Tests that share one study, the costliest of what tests share."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Run these first: processes that take over each other's tests then cannot part them, and the
    study is made once.
    """
    items.sort(key=lambda item: item.path.name != FIRST)


@pytest.fixture(scope="session")
def hyperleg() -> Design:
    """The paper's robot."""
    return load_design("hyperleg")


def _overrides() -> st.SearchStrategy[dict]:
    number = st.floats
    motors = st.sampled_from(sorted(catalogue()))
    entries = {
        "pelvis.mass": number(10, 40),
        "thigh.mass": number(5, 12),
        "shank.mass": number(0.8, 4),
        "foot.mass": number(0.3, 2),
        "toe.mass": number(0.05, 1),
        "thigh.length": number(0.25, 0.5),
        "shank.length": number(0.25, 0.5),
        "thigh.com_fraction": number(0.2, 0.6),
        "thigh.com_outward": number(-0.03, 0.03),
        "shank.com_forward": number(-0.03, 0.03),
        "foot.ball_length": number(0.08, 0.16),
        "foot.com": st.lists(number(-0.05, 0.05), min_size=3, max_size=3),
        "toe.length": number(0.03, 0.09),
        "hip.spacing": number(0.12, 0.3),
        "actuators.hip_pitch.gear": number(8, 40),
        "actuators.knee.gear": number(4, 12),
        "actuators.ankle.gear": number(4, 12),
        "actuators.toe.gear": number(4, 12),
        "actuators.hip_pitch.motor": motors,
        "actuators.knee.motor": motors,
        "actuators.ankle.motor": motors,
        "actuators.toe.motor": motors,
        "actuators.ankle.housed_in": st.sampled_from(["thigh", "shank", "pelvis"]),
        "actuators.knee.position_fraction": number(0, 0.8),
        "transmission.scale.knee": number(0.5, 2),
        "transmission.scale.ankle_pitch": number(0.5, 2),
        "transmission.scale.toe": number(0.5, 2),
        "transmission.posture": st.sampled_from(["walking", "standing"]),
        "electrical.constants": st.sampled_from(["paper", "vendor"]),
    }
    return st.fixed_dictionaries({}, optional=entries)


@pytest.fixture(scope="session")
def random_designs(hyperleg: Design) -> st.SearchStrategy[Design]:
    """Strategy for valid robots that differ from the paper's in masses, lengths, gears, motors,
    places and variant.
    """

    @st.composite
    def made(draw) -> Design:
        values = draw(_overrides())
        variant = draw(st.sampled_from(["toe", "toe_locked", "toe_removed_matched", "toe_removed"]))
        try:
            design = load_design(
                "hyperleg",
                overrides={
                    k: v for k, v in values.items() if (k, variant) != ("toe.mass", "toe_removed")
                },
                variant=variant,
            )
            inertials(design)
        except InputError:
            design = load_design("hyperleg", variant=variant)
        return design

    return made()


@pytest.fixture
def write(tmp_path: Path):
    """Writes a text to a file of a name, and gives its path."""

    def written(name: str, text: str | bytes) -> Path:
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return written


@pytest.fixture(scope="session")
def rng() -> np.random.Generator:
    return np.random.default_rng(0)
