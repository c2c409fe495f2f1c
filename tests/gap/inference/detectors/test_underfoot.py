import pytest

from hyperleg_design.gap.inference.detectors.underfoot import Underfoot


def foot(size: float, left: float) -> Underfoot:
    return Underfoot("ground_friction", "left_foot", {}, "slip", "", 1.0, size, left, "N")


@pytest.mark.parametrize(("left", "closed"), [(0.0, 1.0), (0.5, 0.75), (2.0, 0.0), (3.0, -0.5)])
def test_the_gap_that_is_closed_is_what_is_not_left_of_it(left, closed):
    assert foot(2.0, left).closed == closed


def test_no_unit_changes_what_is_closed():
    assert foot(2e-3, 5e-4).closed == pytest.approx(foot(2.0, 0.5).closed)


def test_a_foot_is_named_by_effect_and_place():
    assert foot(1.0, 0.5).name == ("ground_friction", "left_foot")
