from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.robot.build import design_yaml
from hyperleg_design.robot.check import check_file, finding_of, kind_of
from hyperleg_design.robot.description import urdf
from hyperleg_design.robot.mjcf import mjcf

DESIGNS = sorted(resources.content_folder("descriptions").glob("*.yaml"))
MOTORS = sorted(resources.content_folder("motors").glob("*.yaml"))


@pytest.mark.parametrize("path", [*DESIGNS, *MOTORS], ids=lambda p: p.name)
def test_everything_shipped_is_right(path):
    assert check_file(path) == []
    assert kind_of(path) == ("motor" if path in MOTORS else "design")


def test_a_bare_name_is_a_shipped_design():
    assert kind_of("toe_removed") == "design"
    assert check_file("toe_removed") == []


def test_kinds_go_by_content(write, hyperleg):
    robot, model = urdf(hyperleg), mjcf(hyperleg)
    for name, text, kind in (
        ("a.urdf", robot, "urdf"),
        ("b.xml", robot, "urdf"),
        ("c.xml", model, "mjcf"),
        ("d.yaml", design_yaml(hyperleg), "design"),
    ):
        path = write(name, text)
        assert kind_of(path) == kind
        assert check_file(path) == []


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.urdf", "<robot name='x'>", "not XML"),
        ("a.urdf", "<robot name='x'/>", "no links"),
        ("a.xml", "<html/>", "no kind"),
        ("a.xml", "<mujoco>", "not XML"),
        ("a.txt", "hello", "no kind"),
        ("a.yaml", "x: 1", "no kind"),
        ("a.yaml", "x: [1", "not YAML"),
        ("a.yaml", "x: 1\nx: 2", "line 2"),
        ("a.yaml", b"\xff", "UTF-8"),
        ("a.yaml", "base: hyperleg\ntoe: {mass: -1}", "toe.mass: is -1"),
        (
            "a.yaml",
            "base: hyperleg\nthigh: {gyration_fraction: [0.03, 0.03, 0.03]}\nactuators: "
            "{hip_pitch: {motor: U8}}",
            "thigh.gyration_fraction",
        ),
        ("a.yaml", "pelvis: {}", "missing"),
        ("a.yaml", "constants: {}\nconvention: {}", "missing"),
    ],
)
def test_a_fault_is_one_finding(write, name, text, words):
    found = check_file(write(name, text))
    assert len(found) == 1
    assert found[0].severity == "error"
    assert words in str(found[0])
    assert found[0].message


def test_a_design_whose_linkage_cannot_be_is_a_warning(write):
    path = write("a.yaml", "base: hyperleg\ntransmission: {walking: {ankle_pitch: 500}}")
    assert [(f.severity, "four-bar" in str(f)) for f in check_file(path)] == [("warning", True)]


def test_ranges_typed_in_radians_are_a_warning(write):
    text = resources.find("descriptions", "teaching_leg").read_text()
    data = yaml.safe_load(text)
    for joint in data["joints"].values():
        for end in ("lower_deg", "upper_deg", "default_deg"):
            if end in joint:
                value = joint[end]["value"] if isinstance(joint[end], dict) else joint[end]
                joint[end] = float(np.deg2rad(value))
    (found,) = check_file(write("a.yaml", yaml.safe_dump(data)))
    assert (found.severity, found.place) == ("warning", "joints")
    assert "wider than" in found.message
    assert "are degrees" in found.remedy
    next(iter(data["joints"].values()))["upper_deg"] = 90  # one joint that moves is enough
    assert check_file(write("a.yaml", yaml.safe_dump(data))) == []


@pytest.mark.parametrize(
    "name", ["gone.urdf", "gone.xml", "gone.yaml", "gone", "no/such/file.urdf"]
)
def test_a_missing_file(name):
    with pytest.raises(InputError, match=r"gone|no/such"):
        check_file(name)


def test_findings_of_errors():
    found = finding_of(InputError("a.yaml", "toe.mass", -1, "expects kg"))
    assert str(found) == "error: a.yaml: toe.mass: is -1; expects kg"
    assert (
        str(finding_of(InputError("a.yaml", "toe.mass", None, "is missing"), "warning"))
        == "warning: a.yaml: toe.mass: is missing"
    )


def test_an_unreadable_folder(tmp_path: Path):
    with pytest.raises(InputError):
        check_file(tmp_path)
