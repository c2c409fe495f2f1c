"""New causes beside standing ones: their traces together against both effects at once."""

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.assembly import evidence_of
from hyperleg_design.gap.inference.interactions import Acting, beside
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject

MOTOR = "m_back"


@pytest.fixture(scope="module")
def tests(robot_files):
    return diagnosed.evidence(robot_files["coupled"], diagnosed.run("limited", 0)).tests


def after(samples, causes):
    """What causes in drives leave."""
    return beside(samples, EFFECTS["torque_constant"], causes, len(samples.filtered_logs))


def standing(effect, *values):
    return [Acting(effect, MOTOR, True, np.array(values))]


def trace(samples, effect, *values):
    one = EFFECTS[effect]
    return samples.columns(lambda s: one.trace(s, MOTOR, np.array([values])), 1)[0]


def test_scales_of_one_motor_multiply(tests):
    lacking = standing("torque_constant", 0.8, 0.0)
    added = trace(after(tests, lacking), "torque_constant", 0.75, 0.0)
    both = trace(tests, "torque_constant", 0.8, 0.0) + added
    np.testing.assert_allclose(both, trace(tests, "torque_constant", 0.6, 0.0), atol=1e-9)


def test_a_lag_after_a_lag_is_that_of_both_in_a_row(tests):
    effect = EFFECTS["actuator_bandwidth"]
    late = after(tests, standing("actuator_bandwidth", 0.03))
    signals, lagging = (one.filtered_logs[0].signals for one in (tests, late))
    motor = signals.subject.motors.index(MOTOR)
    first = effect.trace(signals, MOTOR, np.array([[0.03]]))["drive"][0, :, motor]
    np.testing.assert_allclose(lagging.command[:, motor], signals.command[:, motor] + first)
    alone = trace(tests, "actuator_bandwidth", 0.01)
    assert np.abs(trace(late, "actuator_bandwidth", 0.01)).max() < np.abs(alone).max()


def test_what_was_measured_stays(tests):
    late = after(tests, standing("actuator_bandwidth", 0.03))
    np.testing.assert_array_equal(late.value, tests.value)
    assert late.filtered_logs[0].signals.residual is tests.filtered_logs[0].signals.residual


@pytest.mark.parametrize("standing", [False, True])
def test_gears_rub_by_all_that_they_carry(robot_files, standing):
    """A load beside friction under load, against a model that carries the load already."""
    found = diagnosed.evidence(
        robot_files["coupled"],
        diagnosed.run("healthy", 0),
        references=(diagnosed.run("healthy", 1, role="reference"),),
    )
    values = np.array([0.5, 0.0, 0.0, -0.2, 0.0])
    load = [Acting("payload", "shank", standing, values)]
    carried = beside(found.samples, EFFECTS["load_dependent_friction"], load, 1)
    np.testing.assert_array_equal(carried.value, found.samples.value)
    load = Metadata(payload={"shank": (0.5, 0.0, 0.0, -0.2)})
    for place, log in enumerate(carried.filtered_logs):
        signals = log.signals
        loaded = condition(signals.log.changed(metadata=load), signals.subject)
        plain = found.samples.filtered_logs[place].signals
        here = standing or place == 0
        assert not np.allclose(loaded.rigid, plain.rigid, atol=0.1)
        np.testing.assert_allclose(signals.rigid, (loaded if here else plain).rigid, atol=1e-6)


SERVO = """<mujoco><worldbody><body name="arm"><joint name="hinge" axis="0 1 0" armature="0.01"/>
  <inertial pos="0 0 -0.1" mass="0.3" diaginertia="0.001 0.001 0.0001"/></body></worldbody>
  <actuator><position name="hinge" joint="hinge" kp="12" kv="0.5" forcerange="-1.5 1.5"/></actuator>
</mujoco>"""


@pytest.mark.parametrize("measured", [True, False])
def test_a_softer_controller_multiplies_the_error_of_late_targets_and_limits_act_last(
    tmp_path, measured
):
    """Against the torque of such a controller, written out."""
    (tmp_path / "servo.xml").write_text(SERVO)
    time = np.arange(0, 10, 0.005)
    position = 0.8 * np.sin(2 * time) + 0.3 * np.sin(5 * time)
    speed = 1.6 * np.cos(2 * time) + 1.5 * np.cos(5 * time)
    target = position + 0.16 * speed
    signals = {"position/hinge": position, "position_target/hinge": target}
    if measured:
        signals["motor_torque/hinge"] = np.zeros_like(time)
    log = Log("servo", time, signals, Metadata(targets="moving"))
    samples = evidence_of(
        [condition(log, load_subject(tmp_path / "servo.xml"))], [], InferenceRules()
    ).tests
    late, softer = np.array([0.015, 1.0]), np.array([0.7, 0.9])
    delay = EFFECTS["command_delay"]
    lacking = [Acting("command_delay", "robot", True, late)]
    (log_after,) = after(samples, lacking).filtered_logs

    def given(stiffness, damping, delayed):
        old = np.interp(time - delayed, time, target)
        asked = 12 * stiffness * (old - position) - 0.5 * damping * speed
        return np.clip(asked, -1.5, 1.5)

    residual = "drive" if measured else "motion"
    own = samples.filtered_logs[0].signals
    first = delay.trace(own, "robot", late[None])[residual][0, :, 0]
    gain = EFFECTS["controller_gain"]
    second = gain.trace(log_after.signals, "hinge", softer[None])[residual][0, :, 0]
    change = given(0.7, 0.9, 0.015) - given(1.0, 1.0, 0.0)
    inside = slice(20, -20)
    found = (first + second) if measured else -(first + second)
    assert np.abs(change).max() > 0.8
    np.testing.assert_allclose(found[inside], change[inside], atol=0.02)
    alone = gain.trace(own, "hinge", softer[None])[residual][0, :, 0]
    assert np.abs(first + alone - (first + second)).max() > 0.1
