"""The mass of a URDF's robot against its size."""

from __future__ import annotations

import re

import pytest

from hyperleg_design.robot.checks.check_urdf import check_urdf
from hyperleg_design.sizing.other_robots import robots_folder


@pytest.mark.parametrize(
    "file", ["solo_description/robots/solo12.urdf", "ur_description/urdf/ur5_robot.urdf"]
)
def test_masses_in_grams_are_a_warning(file):
    text = (robots_folder() / file).read_text()
    assert not [f for f in check_urdf(text) if "grams" in f.remedy]
    grams = re.sub(
        r'(mass value|i[xyz]{2})="([^"]+)"',
        lambda match: f'{match[1]}="{1000 * float(match[2])}"',
        text,
    )
    (finding,) = [f for f in check_urdf(grams) if "grams" in f.remedy]
    assert (finding.severity, finding.place) == ("warning", "<robot>")
