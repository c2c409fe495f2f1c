"""Overlays: files that read back, wrong ones that are told in one line, and simulations that
change.
"""

from __future__ import annotations

import json
import pickle

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.model.design_subject import subject_of
from hyperleg_design.gap.playback.overlay import (
    Overlay,
    overlay_from_mapping,
    overlay_of_diagnosis,
    read_overlay,
    write_overlay,
)
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.tasks import load_task

CHANGE = {
    ("coulomb_friction", "left_knee"): {"torque": 1.0 / 3.0},
    ("payload", "left_toe"): {"mass": 0.5, "com_x": 0.02},
}


@pytest.fixture(scope="module")
def design():
    return load_design()


def written(**changes):
    base = {
        "schema": 1,
        "robot": "hyperleg",
        "effects": [{"effect": "payload", "location": "pelvis", "parameters": {"mass": 2.0}}],
    }
    return {**base, **changes}


def test_a_file_reads_back_to_the_last_digit(tmp_path):
    overlay = Overlay("hyperleg", CHANGE, {"diagnosis": "x.json", "closed": 0.9})
    found = read_overlay(write_overlay(tmp_path / "overlay.yaml", overlay))
    assert found == overlay
    assert found.change["coulomb_friction", "left_knee"]["torque"] == 1.0 / 3.0
    assert overlay_from_mapping(overlay.mapping(), "x") == overlay
    assert pickle.loads(pickle.dumps(overlay)) == overlay


def test_links_may_be_named_by_the_joint_that_carries_them(design):
    subject = subject_of(design)
    by_joint, by_link = (
        Overlay("", {("payload", place): {"mass": 1.0}}).alterations(subject)[0]
        for place in ("left_toe", "left_toe_plate")
    )
    assert by_joint.body == by_link.body == "left_toe_plate"
    np.testing.assert_array_equal(by_joint.added, by_link.added)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (written(schema=2), "schema = 2: expects 1"),
        (written(effects={}), "expects a list"),
        (written(effects=[3]), "expects effect, location and parameters"),
        (written(efects=[]), "did you mean effects"),
        (written(robot=3), "expects a name"),
        (written(source=3), "expects a mapping"),
        (written(effects=[{"effect": "paylod", "location": "pelvis"}]), "did you mean payload"),
        (written(effects=[{"effect": "payload"}]), r"effects.0.location"),
        (
            written(
                effects=[{"effect": "payload", "location": "pelvis", "parameters": {"weight": 1}}]
            ),
            r"parameters.weight: no such field",
        ),
        (
            written(
                effects=[
                    {"effect": "payload", "location": "pelvis", "parameters": {"mass": "much"}}
                ]
            ),
            "expects a finite number",
        ),
        (
            written(
                effects=[{"effect": "payload", "location": "pelvis", "parameters": {"mass": True}}]
            ),
            "expects a finite number",
        ),
        (
            written(
                effects=[
                    {
                        "effect": "payload",
                        "location": "pelvis",
                        "parameters": {"mass": float("nan")},
                    }
                ]
            ),
            "expects a finite number",
        ),
        (
            written(
                effects=[{"effect": "payload", "location": "pelvis", "parameters": {"mass": 1e9}}]
            ),
            r"expects -10000 .. 10000 kg",
        ),
        (
            written(effects=[{"effect": "payload", "location": "pelvis", "parameters": [1]}]),
            "expects a mapping of numbers",
        ),
        (written(effects=written()["effects"] * 2), "stands twice"),
    ],
)
def test_wrong_files_are_told_in_one_line(content, message):
    with pytest.raises(InputError, match=message) as caught:
        overlay_from_mapping(content, "overlay.yaml")
    assert "\n" not in str(caught.value)


def test_what_is_no_yaml_is_told(tmp_path):
    path = tmp_path / "overlay.yaml"
    for text in ("[1, 2", "- a", "schema: 1\nschema: 2"):
        path.write_text(text)
        with pytest.raises(InputError, match=r"overlay\.yaml"):
            read_overlay(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_overlay(tmp_path / "nothing.yaml")


@pytest.mark.parametrize(
    ("place", "message"),
    [
        (("payload", "left_tow"), "did you mean"),
        (("coulomb_friction", "elbow"), "there are"),
        (("ground_friction", "left_hand"), "left_foot"),
    ],
)
def test_places_that_the_robot_lacks_are_told(design, place, message):
    name = {"payload": "mass", "coulomb_friction": "torque", "ground_friction": "scale"}[place[0]]
    with pytest.raises(InputError, match=message):
        Overlay("", {place: {name: 0.7}}).alterations(design)


def test_feet_of_an_arm_are_told(robot_files):
    with pytest.raises(InputError, match="no foot"):
        Overlay("", {("ground_friction", "foot"): {"scale": 0.7}}).alterations(
            load_subject(robot_files["arm"])
        )


def test_a_diagnosis_becomes_an_overlay(tmp_path):
    path = tmp_path / "diagnosis.json"
    cause = {
        "effect": "coulomb_friction",
        "location": "left_knee",
        "probability": 0.97,
        "closed": 0.93,
    }
    cause["parameters"] = {"torque": {"value": 1.9, "low": 1.7, "high": 2.1, "unit": "Nm"}}
    content = {"schema": 1, "verdict": "explained", "gap": {"closed": 0.93}, "causes": [cause]}
    path.write_text(json.dumps(content))
    found = overlay_of_diagnosis(path, "hyperleg")
    assert found.robot == "hyperleg"
    assert found.change == {("coulomb_friction", "left_knee"): {"torque": 1.9}}
    assert overlay_of_diagnosis(tmp_path, "hyperleg").change == found.change
    assert found.source == {"diagnosis": str(path), "verdict": "explained", "closed": 0.93}
    assert overlay_of_diagnosis(path).robot == ""
    path.write_text(json.dumps(content | {"provenance": {"robot": "arm"}}))
    assert overlay_of_diagnosis(path).robot == "arm"
    assert overlay_of_diagnosis(path, "hyperleg").robot == "hyperleg"
    for broken, message in (
        ({**content, "causes": [], "verdict": "none"}, "nothing to add: the verdict is none"),
        ({**content, "causes": [{"effect": "payload"}]}, r"causes.0"),
        ({**content, "causes": [{**cause, "effect": "magic"}]}, "there are"),
        ({**content, "schema": 7}, "is not a diagnosis"),
        ([], "is not a diagnosis"),
    ):
        path.write_text(json.dumps(broken))
        with pytest.raises(InputError, match=message):
            overlay_of_diagnosis(path)
    path.write_text("{")
    with pytest.raises(InputError, match="is not JSON"):
        overlay_of_diagnosis(path)
    with pytest.raises(InputError, match="cannot be read"):
        overlay_of_diagnosis(tmp_path / "none.json")


def test_an_environment_takes_an_overlay_and_an_empty_one_changes_no_bit(design):
    def stood(alterations):
        environment = Environment(
            design, load_task("walk"), simulations=3, seed=1, threads=1, alterations=alterations
        )
        environment.reset()
        for _ in range(20):
            step = environment.step(np.full((3, environment.action_size), 0.1))
        return step.observations["policy"]

    plain = stood(None)
    np.testing.assert_array_equal(stood(Overlay("hyperleg", {}).alterations), plain)
    assert np.abs(stood(Overlay("hyperleg", CHANGE).alterations) - plain).max() > 1e-3


def test_what_a_diagnosis_tells_for_people_is_left_out(tmp_path):
    def cause(**values):
        parameters = {
            name: {"value": v, "low": v, "high": v, "unit": ""} for name, v in values.items()
        }
        return {
            "effect": "torque_saturation",
            "location": "left_knee",
            "probability": 0.9,
            "closed": 0.9,
            "parameters": parameters,
        }

    path = tmp_path / "diagnosis.json"
    path.write_text(
        json.dumps(
            {
                "schema": 1,
                "verdict": "explained",
                "gap": {"closed": 0.9},
                "causes": [cause(inverse_limit=0.1, limit=10.0)],
            }
        )
    )
    assert overlay_of_diagnosis(path).change == {
        ("torque_saturation", "left_knee"): {"inverse_limit": 0.1}
    }
    path.write_text(
        json.dumps(
            {
                "schema": 1,
                "verdict": "explained",
                "gap": {"closed": 0.9},
                "causes": [cause(limit=10.0)],
            }
        )
    )
    with pytest.raises(InputError, match="none is a parameter"):
        overlay_of_diagnosis(path)
