"""Every effect can be shown alone, and its trace is what a simulation with it leaves."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.playback import show as module
from hyperleg_design.gap.playback.show import effects_table, show

QUICK = ("coulomb_friction", "payload", "command_delay", "backlash", "imu_bias")
"""Effects on a joint, a link, the robot, a motor and a sensor; the others run among slow tests."""

TOLD_APART = {
    "coulomb_friction",
    "viscous_friction",
    "load_dependent_friction",
    "torque_constant",
    "thermal_derating",
    "command_delay",
    "rotor_inertia",
    "transmission_elasticity",
    "controller_gain",
    "payload",
    "link_mass",
    "link_com",
    "cogging",
    "joint_spring",
    "torque_saturation",
    "ground_friction",
    "ground_compliance",
    "imu_bias",
    "voltage_sag",
    "encoder_offset",
}
"""Whose trace explains most of a residual even unfiltered."""


@pytest.fixture(scope="module")
def without_effect():
    """Simulations without an effect, by robot and targets: those of most effects are the same."""
    return {}


@pytest.fixture(autouse=True)
def short(monkeypatch, without_effect):
    simulated = module.simulated_log

    def once(subject, target, time, alterations):
        if alterations:
            return simulated(subject, target, time, alterations)
        key = subject.name, subject.model.body_mass.tobytes(), target.tobytes()
        if key not in without_effect:
            without_effect[key] = simulated(subject, target, time, alterations)
        return without_effect[key]

    monkeypatch.setattr(module, "simulated_log", once)
    monkeypatch.setattr(module, "DURATION", 4.0)
    monkeypatch.setattr(module, "STANDING", 2.0)


@pytest.mark.parametrize(
    "name", [pytest.param(e, marks=() if e in QUICK else pytest.mark.slow) for e in EFFECTS]
)
def test_every_effect_leaves_a_trace_and_moves_the_loop(name):
    shown = show(name)
    known = np.isfinite(shown.trace) & np.isfinite(shown.residual) & (shown.time > 0.5)
    assert shown.residual_name
    assert known.mean() > 0.7
    trace, residual = shown.trace[known], shown.residual[known]
    assert np.abs(trace).max() > 0
    if name in TOLD_APART:
        middle = np.abs(residual) < np.quantile(np.abs(residual), 0.98)  # spikes at reversals aside
        assert np.mean((residual - trace)[middle] ** 2) < 0.4 * np.mean(residual[middle] ** 2)
    moved = np.abs(shown.after - shown.before).max()
    # no sensor of the base is in this loop
    assert (moved == 0) == (name == "imu_bias")
    assert len(shown.time) == len(shown.target) == len(shown.position) == len(shown.torque)


def test_settings_and_places_are_taken_and_checked(robot_files):
    shown = show(
        "viscous_friction", str(robot_files["arm"]), location="elbow", settings=["damping=3.5"]
    )
    assert shown.parameters == {"damping": 3.5}
    assert shown.row == shown.joint == "elbow"
    speed = np.abs(shown.velocity) > 0.1
    np.testing.assert_allclose(
        (shown.trace / shown.velocity)[speed & np.isfinite(shown.trace)], 3.5, rtol=0.02
    )
    for wrong, message in (
        ("damping", "PARAMETER=VALUE"),
        ("mass=1", "there are damping"),
        ("dampng=1", r"did you mean damping\?"),
        ("damping=x", "expects a number"),
        ("damping=-1e9", r"\.\."),
    ):
        with pytest.raises(InputError, match=message):
            show("viscous_friction", settings=[wrong])
    with pytest.raises(InputError, match="did you mean elbow"):
        show("viscous_friction", str(robot_files["arm"]), location="elbw")
    with pytest.raises(InputError, match="did you mean backlash"):
        show("backlach")


def test_our_biped_is_shown_on_a_stand():
    shown = show("coulomb_friction", "hyperleg", location="left_ankle_pitch")
    assert shown.joint == "left_ankle_pitch"
    assert np.ptp(shown.before) > 0.2
    assert set(np.sign(shown.trace[np.isfinite(shown.trace)])) == {-1.0, 1.0}


def test_the_table_has_all_that_a_reader_needs():
    table = effects_table()
    assert [row["effect"] for row in table] == list(EFFECTS)
    for row in table:
        assert row["where"] in ("joint", "motor", "link", "foot", "sensor", "robot")
        assert row["summary"]
        assert all(p["source"] and "typical" in p and "unit" in p for p in row["parameters"])
