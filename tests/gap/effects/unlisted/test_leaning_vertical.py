"""Bases that are not level, against Pinocchio's inverse dynamics and in plain MuJoCo."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest
import robots
from pinocchio_tree import pinocchio_model
from random_motion import random_motion

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects import EFFECTS, UNLISTED, WEIGHED
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.signals.loading import load_subject

LEANING = WEIGHED["leaning_vertical"]
TURRET = robots.COUPLED.replace('name="hip" axis="0 1 0"', 'name="hip" axis="0 0 1"')
"""The hip turns about the vertical, so that a vertical that leans is no other zero of a joint."""


def test_answers_name_no_such_cause():
    assert "leaning_vertical" in UNLISTED
    assert "leaning_vertical" not in EFFECTS
    assert set(WEIGHED) == set(EFFECTS) | UNLISTED


def test_it_is_the_torque_that_another_gravity_takes(robot_files):
    subject = load_subject(robot_files["arm"])
    q, v, a, _ = random_motion(subject)
    values = np.array([0.03, -0.2])
    signals = SimpleNamespace(subject=subject, position=q, base=None)
    (found,) = LEANING.trace(signals, "robot", values)["motion"]
    across = [LEANING.trace(signals, "robot", row)["motion"][0] for row in np.eye(2)]
    np.testing.assert_allclose(found, values[0] * across[0] + values[1] * across[1], atol=1e-12)
    # of all horizontal gravities as long as the declared one, two across each other make the trace
    model = [
        pinocchio_model(subject.tree, subject.gravity + 9.81 * np.array([*lean, 0.0]))
        for lean in (np.zeros(2), *np.eye(2))
    ]
    states = list(zip(q, v, a, strict=True))
    torques = np.array([[pin.rnea(m, m.createData(), *row) for row in states] for m in model])
    turns = (torques[1:] - torques[0]).reshape(2, -1)
    share = np.linalg.lstsq(turns.T, found.ravel(), rcond=None)[0]
    np.testing.assert_allclose(share @ turns, found.ravel(), atol=1e-8)
    assert np.linalg.norm(share) == pytest.approx(
        np.hypot(*values) * np.linalg.norm(subject.gravity) / 9.81
    )


@pytest.mark.parametrize(
    ("name", "places"), [("arm", ("robot",)), ("coupled", ()), ("pendulum", ())]
)
def test_on_parallel_axes_it_is_another_zero_of_the_first(robot_files, name, places):
    assert LEANING.locations(load_subject(robot_files[name])) == places


def test_a_robot_without_weight_has_none_and_one_that_floats_has(robot_files):
    subject = load_subject(robot_files["arm"])
    assert LEANING.locations(replace(subject, gravity=np.zeros(3))) == ()
    coupled = load_subject(robot_files["coupled"])
    floating = replace(coupled, tree=replace(coupled.tree, floating=True))
    assert LEANING.locations(floating) == ("robot",)


def test_it_says_the_angle_and_is_added_to_no_simulation(robot_files):
    assert "0.05 rad" in LEANING.describe(np.array([0.03, -0.04]))
    with pytest.raises(InputError, match="gravity"):
        LEANING.alteration("robot", np.zeros(2), load_subject(robot_files["arm"]))


def test_a_leaning_robot_is_unknown_and_told_its_angle(tmp_path):
    file = tmp_path / "turret.xml"
    file.write_text(TURRET)
    leaning = TURRET.replace("<option ", '<option gravity="0.7 -0.4 -9.79" ')
    logs = [
        robots.noisy(robots.servo_run(leaning, robots.waves(2, [1.5, 1.5], seed=s), 12.0), s)
        for s in (0, 1)
    ]
    found = diagnose(file, logs, threads=1)
    assert (found.verdict, found.causes) == ("unknown", ())
    assert found.remainder == pytest.approx(1.0)
    shape = found.residual_shape[0]
    assert (shape["shape"], shape["location"]) == ("leaning_vertical", "robot")
    angle = float(shape["says"].split("leans by ")[1].split(" rad")[0])
    assert angle == pytest.approx(np.hypot(0.7, 0.4) / 9.81, rel=0.1)
