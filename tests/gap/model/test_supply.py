import math
from functools import cache

import numpy as np
import pytest
import robots
from diagnosed import conditioned

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.model.supply import driven_by_duty, over_nominal
from hyperleg_design.gap.pipeline.diagnose import diagnose_signals
from hyperleg_design.gap.playback.replay import replay
from hyperleg_design.gap.playback.windows import short_windows
from hyperleg_design.gap.signals.loading import load_subject

NOMINAL, CONSTANT, RESISTANCE, GAIN = 7.4, 0.3, 3.4, 3.0
"""Supply [V], kt [Nm/A], R [ohm], duty a radian of error."""
STIFFNESS, DAMPING = GAIN * NOMINAL * CONSTANT / RESISTANCE, CONSTANT**2 / RESISTANCE
STEP, EVERY, MASS, LENGTH, INERTIA = 1e-4, 50, 0.2, 0.1, 4e-4
SERVO = f"""
<mujoco model="servo">
  <worldbody>
    <body name="arm" pos="0 0 1">
      <joint name="swing" axis="0 1 0"/>
      <inertial pos="0 0 {-LENGTH}" mass="{MASS}" diaginertia="{INERTIA} {INERTIA} 1e-4"/>
    </body>
  </worldbody>
  <actuator><motor name="servo" joint="swing"/></actuator>
</mujoco>
"""


def voltage(time):
    """A battery that sags by a third, to and fro."""
    return 6.8 + 1.1 * np.sin(3.1 * time) - 0.05 * time


@cache
def run(gain=GAIN, declared=STIFFNESS, reading=CONSTANT, duration=10.0, seed=0):
    """A pendulum on a motor whose duty cycle is gain times error, clipped to one: current (duty V -
    kt speed) / R.
    """
    rng = np.random.default_rng(seed)
    phases = rng.uniform(0, 6, 3)
    times = np.arange(round(duration / STEP)) * STEP
    targets = 0.8 * np.sin(1.7 * times + phases[0]) + 0.3 * np.sin(4.1 * times + phases[1])
    targets += 0.25 * np.sign(np.sin(0.9 * times + phases[2]))
    q, v, rows, heavy = 0.0, 0.0, [], INERTIA + MASS * LENGTH**2
    each = zip(times.tolist(), targets.tolist(), voltage(times).tolist(), strict=True)
    for tick, (time, target, volts) in enumerate(each):
        duty = min(max(gain * (target - q), -1.0), 1.0)
        current = (duty * volts - CONSTANT * v) / RESISTANCE
        if tick % EVERY == 0:
            rows.append((time, target, q, v, current, volts))
        v += STEP * (CONSTANT * current - MASS * 9.81 * LENGTH * math.sin(q)) / heavy
        q += STEP * v
    time, target, q, v, current, volts = np.array(rows).T
    signals = {
        "position_target/swing": target,
        "position/swing": q + rng.normal(0, 2e-5, len(q)),
        "velocity/swing": v,
        "motor_current/swing": current + rng.normal(0, 2e-3, len(q)),
        "battery_voltage": volts,
    }
    metadata = Metadata(
        base="fixed",
        gains={"swing": (declared, DAMPING)},
        torque_constant={"swing": reading},
        supply={"swing": (NOMINAL, CONSTANT / RESISTANCE * NOMINAL, NOMINAL / CONSTANT)},
    )
    return Log(f"run{seed}", time, signals, metadata)


@pytest.fixture(scope="module")
def servo(tmp_path_factory):
    path = tmp_path_factory.mktemp("servo") / "servo.xml"
    path.write_text(SERVO)
    return path


def test_a_drive_that_follows_its_battery_leaves_nothing(servo):
    (signals,) = conditioned(servo, run())
    given = signals.measured[signals.valid]
    assert np.abs(signals.residual["drive"][signals.valid]).max() < 0.05 * np.abs(given).max()
    assert np.std(signals.residual["drive"][signals.valid]) < 0.01 * np.std(given)


def test_without_the_declaration_it_does(servo):
    log = run()
    (signals,) = conditioned(servo, log.changed(metadata=log.metadata.changed(supply={})))
    assert np.std(signals.residual["drive"][signals.valid]) > 0.1 * np.std(
        signals.measured[signals.valid]
    )


def test_ratio_is_one_where_nothing_is_known(servo):
    (signals,) = conditioned(servo, run(duration=2.0))
    subject = signals.subject
    assert over_nominal(subject, None).tolist() == [[1.0]]
    assert over_nominal(subject, np.array([3.7, np.nan]))[:, 0].tolist() == [0.5, 1.0]
    assert over_nominal(load_subject(servo), np.array([3.7])).tolist() == [[1.0]]


def test_a_motor_is_damped_by_the_speed_that_it_has_not_by_that_which_it_tells(servo):
    """A servo tells filtered speeds late; its damping is that of its windings."""
    right = run()
    late = np.interp(right.time - 0.03, right.time, right.signals["velocity/swing"])
    telling = right.changed(signals=right.signals | {"velocity/swing": late})
    (one,), (other,) = conditioned(servo, right), conditioned(servo, telling)
    assert driven_by_duty(one.subject).tolist() == [True]
    np.testing.assert_allclose(other.command, one.command, atol=0.02 * np.abs(one.command).max())
    assert np.std(other.residual["drive"][other.valid]) < 0.02 * np.std(one.measured[one.valid])
    asked = [
        conditioned(servo, log.changed(metadata=log.metadata.changed(supply={})))[0].command
        for log in (right, telling)
    ]
    more = -DAMPING * (late - right.signals["velocity/swing"])[:, None]  # as a controller reads it
    np.testing.assert_allclose(asked[1] - asked[0], more, atol=1e-9)


def test_replays_follow_the_battery(servo):
    (signals,) = conditioned(servo, run())
    found = replay(signals, windows=short_windows(signals, 0.5))
    error, _ = found.errors(signals)
    moved = np.abs(
        signals.position[found.windows.ticks] - signals.position[found.windows.start][:, None]
    ).max()
    assert np.nanmax(np.abs(error)) < 0.02 * moved


def test_a_gain_declared_wrongly_is_found_by_its_size(servo):
    found = diagnose_signals(
        conditioned(servo, run(declared=STIFFNESS / 2), run(declared=STIFFNESS / 2, seed=1)),
        threads=1,
    )
    assert [(c.effect, c.location) for c in found.causes] == [("controller_gain", "swing")]
    assert found.causes[0].parameters["stiffness_scale"].value == pytest.approx(2.0, abs=0.05)


def test_a_constant_declared_wrongly_is_one_cause_in_both_balances(servo):
    found = diagnose_signals(
        conditioned(servo, run(reading=1.25 * CONSTANT), run(reading=1.25 * CONSTANT, seed=1)),
        threads=1,
    )
    assert [(c.effect, c.location) for c in found.causes] == [("torque_constant", "swing")]
    assert found.causes[0].parameters["scale"].value == pytest.approx(0.8, abs=0.02)
    assert found.causes[0].parameters["reading"].value == 1.0


def test_a_sagging_battery_is_no_news(servo):
    (signals,) = conditioned(servo, run(duration=2.0))
    assert effect("voltage_sag").trace(signals, "battery", np.array([[1.0, 1.0, 10.0]])) == {}


def test_one_motor_on_a_file_of_somebody_else(tmp_path):
    path = tmp_path / "two.xml"
    path.write_text(robots.PENDULUM)
    blank = Log(
        "blank",
        np.arange(4.0),
        {"position/swing": np.zeros(4)},
        Metadata(base="fixed", supply={"servo": (12.0, 3.0, 8.0)}),
    )
    subject = load_subject(path, [blank])
    assert (subject.supply[0], subject.stall_torque[0], subject.no_load_speed[0]) == (
        12.0,
        3.0,
        8.0,
    )


def test_a_weaker_motor_is_braked_less_by_the_square(servo):
    """A motor whose constant is 0.8 of the declared one, where no current is logged."""
    weak = 0.8

    def positions(seed):
        log = run(seed=seed)
        signals = {k: v for k, v in log.signals.items() if k != "motor_current/swing"}
        volts, stall, free = log.metadata.supply["swing"]
        metadata = log.metadata.changed(
            gains={"swing": (STIFFNESS / weak, DAMPING / weak**2)},
            torque_constant={},
            supply={"swing": (volts, stall / weak, free * weak)},
        )
        return log.changed(signals=signals, metadata=metadata)

    signals = conditioned(servo, positions(0), positions(1))
    found = diagnose_signals(signals, threads=1)
    assert [(c.effect, c.location) for c in found.causes] == [("torque_constant", "swing")]
    assert found.causes[0].parameters["scale"].value == pytest.approx(weak, abs=0.03)
    subject, windows = signals[0].subject, short_windows(signals[0], 0.5)
    change = effect("torque_constant").alteration("swing", np.array([weak, 0.0]), subject)
    played = replay(signals[0], ((), (change,)), windows).errors(signals[0])[0]
    (right,) = conditioned(servo, run())
    least = np.std(replay(right, windows=short_windows(right, 0.5)).errors(right)[0])
    assert np.std(played[1]) == pytest.approx(least, rel=1e-3)
    assert least < 0.3 * np.std(played[0])
