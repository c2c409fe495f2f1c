from dataclasses import replace

import numpy as np

from hyperleg_design.gap.inference.channels.discrepancy import load, shapes


def test_no_shape_holds_a_measured_torque(signals):
    before = shapes(signals, "motion", 0, 12)
    other = replace(signals, believed=3 * signals.believed, measured=3 * signals.measured)
    np.testing.assert_array_equal(shapes(other, "motion", 0, 12), before)
    np.testing.assert_array_equal(load(other, "motion", 0), load(signals, "motion", 0))


def test_shapes_are_finite_and_each_has_all_ticks(signals):
    for residual, column in (("motion", 0), ("motion", 1)):
        found = shapes(signals, residual, column, 12)
        assert found.shape[1] == len(signals.time)
        assert np.isfinite(found).all()


def test_more_waves_are_more_shapes(signals):
    assert len(shapes(signals, "motion", 0, 15)) == len(shapes(signals, "motion", 0, 12)) + 3


def test_friction_of_a_joint_is_among_its_shapes(signals):
    from hyperleg_design.gap.signals.sliding import sliding

    way = sliding(signals)[:, 1]
    assert any(np.allclose(one, way) for one in shapes(signals, "motion", 1, 0))


def test_no_shape_of_the_control_holds_the_logged_command(signals):
    asked = 3 * np.sin(signals.time)[:, None] * np.ones(signals.believed.shape[1])

    def shown(command):
        residual = {**signals.residual, "control": command - asked}
        other = replace(signals, command=command, residual=residual)
        return shapes(other, "control", 0, 12), load(other, "control", 0)

    before, own = shown(asked)
    np.testing.assert_array_equal(own, asked[:, 0])
    for part, expected in zip(shown(0.7 * asked + 1.0), (before, own), strict=True):
        np.testing.assert_allclose(part, expected, atol=1e-9)
