import numpy as np
import pytest
from matplotlib.colors import to_hex

from hyperleg_design.errors import InputError
from hyperleg_design.report.sizing import envelope_figures as figures
from hyperleg_design.report.style import save
from hyperleg_design.robot import transmission
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing.envelope import motor_envelope, torque_limits


@pytest.fixture(scope="module")
def design():
    return load_design("hyperleg")


def longest(axis):
    """The two curves of the envelope, upper and lower."""
    return sorted(
        (line.get_xydata() for line in axis.lines if len(line.get_xdata()) > 100),
        key=lambda d: -d[:, 1].mean(),
    )


def test_envelopes_drawn_are_the_motors_and_their_sums(design):
    figure = figures.torque_speed_figure(design, posture="walking")
    one = motor_envelope(design).select([4])
    for axis, torque_scale, speed_scale in zip(
        figure.axes, (1, 1, 2 * 26.69, 2 * 16.51), (1, 1, 26.69, 16.51), strict=True
    ):
        for curve, limit in zip(
            longest(axis),
            torque_limits(one, longest(axis)[0][:, :1] * speed_scale)[::-1],
            strict=True,
        ):
            np.testing.assert_allclose(curve[:, 1], torque_scale * limit[:, 0], atol=1e-9)
        assert "[" in axis.get_xlabel()
        assert "Nm" in axis.get_ylabel()


def test_operating_points_are_projected_and_coloured_by_power(design):
    rng = np.random.default_rng(0)
    torque, velocity = rng.normal(size=(60, 7)) * 10, rng.normal(size=(60, 7))
    figure = figures.torque_speed_figure(design, torque, velocity)
    matrix = transmission.joint_from_motor(design)
    power = []
    for axis in figure.axes:
        shown = {
            to_hex(line.get_color()): line.get_xydata()
            for line in axis.lines
            if line.get_marker() == "."
        }
        assert sum(map(len, shown.values())) == 60
        assert np.all(shown[figures.MOTORING].prod(1) >= 0)
        assert np.all(shown[figures.REGENERATIVE].prod(1) < 0)
        power.append(sum(points.prod(1).sum() for points in shown.values()))
    motor = np.linalg.solve(matrix, torque.T).T * (velocity @ matrix)
    assert power[0] == pytest.approx(motor[:, 4].sum())
    assert power[1] == pytest.approx(motor[:, 5].sum())
    # pitch and roll split the same power that left and right do
    assert power[2] + power[3] == pytest.approx(power[0] + power[1])


@pytest.mark.parametrize(
    "variant", ["toe", pytest.param("toe_locked", marks=pytest.mark.slow), "toe_removed_matched"]
)
def test_every_variant_can_be_drawn_and_saved(variant, tmp_path):
    robot = load_design("hyperleg", variant=variant)
    figure = figures.torque_speed_figure(robot)
    for ending in ("png", "svg"):
        assert save(figure, tmp_path / f"speed.{ending}", dpi=40).stat().st_size > 4000


def test_bad_input_is_refused(design):
    batch = design.with_values({"toe.mass": np.array([0.2, 0.3])})
    with pytest.raises(InputError, match="batch"):
        figures.torque_speed_figure(batch)
    for points in (
        (np.zeros((3, 7)), None),
        (np.zeros((3, 7)), np.zeros((4, 7))),
        (np.zeros((3, 6)), np.zeros((3, 6))),
    ):
        with pytest.raises(InputError, match="expects both"):
            figures.torque_speed_figure(design, *points)
