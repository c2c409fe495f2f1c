import numpy as np
import pytest

from hyperleg_design import resources
from hyperleg_design.errors import InfeasibleError
from hyperleg_design.gap.experiments.rig_room import (
    LARGEST,
    NEARER,
    followed,
    rated_torque,
    room_of,
    targets_for,
    use_of,
)
from hyperleg_design.gap.model.design_subject import subject_of
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.robot.design import load_design

LIMITED = """
<mujoco model="limited">
  <worldbody>
    <body name="arm" pos="0 0 1">
      <joint name="swing" axis="0 1 0" range="{low} {high}" damping="0.02" armature="0.003"
        frictionloss="{friction}"/>
      <inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.0006 0.0006 0.0001"/>
    </body>
  </worldbody>
  <actuator>
    <position name="servo" joint="swing" kp="6" kv="0.15" forcerange="-{peak} {peak}"/>
  </actuator>
</mujoco>
"""


@pytest.fixture(scope="module")
def leg():
    return subject_of(load_design(resources.find("descriptions", "hyperleg")), "fixed")


def of_text(tmp_path, low, high, peak=2.0, friction=0.0):
    path = tmp_path / "limited.xml"
    path.write_text(LIMITED.format(low=low, high=high, peak=peak, friction=friction))
    return load_subject(str(path))


def test_room_lies_inside_the_joints_range_with_freedom_to_both_sides(leg):
    room = room_of(leg)
    assert (room.low > leg.position_low).all()
    assert (room.high < leg.position_high).all()
    assert (room.reach > 0.2).all()


def test_no_motor_passes_its_share_of_no_load_speed_at_the_allowed_speeds(leg):
    motors = np.abs(leg.joint_from_motor).T @ room_of(leg).speed
    assert (motors <= 0.6 * leg.no_load_speed * (1 + 1e-9)).all()


def test_rated_torque_is_the_data_sheets_and_below_the_peak(leg):
    assert (rated_torque(leg) < leg.torque_limit).all()


def test_a_hold_needs_gravitys_torque_and_uses_that_share_of_the_motor(tmp_path):
    subject = of_text(tmp_path, -120, 120)
    position = np.full((400, 1), 0.7)
    gravity = 0.5 * 9.81 * 0.1 * np.sin(0.7)
    assert np.abs(followed(subject, position, 0.005)[1]) == pytest.approx(gravity, rel=1e-9)
    use = use_of(subject, room_of(subject), position, 0.005)
    assert use.envelope == pytest.approx(gravity / 2, rel=1e-6)
    assert use.continuous == pytest.approx(gravity / (0.4 * 2), rel=1e-6)
    assert use.speed == 0


def test_motion_that_is_too_hard_does_not_fit(tmp_path):
    subject = of_text(tmp_path, -120, 120)
    time = np.arange(800) / 200
    calm, wild = (0.3 * np.sin(2 * np.pi * f * time)[:, None] for f in (0.5, 12.0))
    room = room_of(subject)
    assert use_of(subject, room, calm, 0.005).fits(True)
    assert not use_of(subject, room, wild, 0.005).fits(True)


def test_past_the_voltage_line_nothing_fits(leg):
    room = room_of(leg)
    time = np.arange(400) / 200
    position = room.centre + 0.5 * np.sin(2 * np.pi * 8 * time)[:, None]
    assert use_of(leg, room, position, 0.005).envelope > 1


def test_targets_lead_by_torque_over_stiffness(tmp_path):
    subject = of_text(tmp_path, -120, 120)
    position = np.full((50, 1), 0.7)
    assert targets_for(subject, position, 0.005) - position == pytest.approx(
        0.5 * 9.81 * 0.1 * np.sin(0.7) / 6, rel=1e-9
    )


def test_a_joint_without_range_is_refused(tmp_path):
    with pytest.raises(InfeasibleError, match="swing"):
        room_of(of_text(tmp_path, -1, 1))


@pytest.mark.parametrize("peak", [2.0, 0.9, 0.7, 0.4])
def test_motions_are_as_wide_as_the_motors_can_hold_their_centre(tmp_path, peak):
    """The arm hangs at zero, near the lower end of its range, so a wide motion is held up."""
    room = room_of(of_text(tmp_path, -10, 120, peak))
    size = float(room.centre[0] - room.low[0])
    sizes = LARGEST * NEARER
    held = 0.8 * 0.4 * peak / (0.5 * 9.81 * 0.1)
    allowed = [s for s in sizes if np.sin(room.low[0] + s) <= held]
    assert size == pytest.approx(allowed[0])


def test_a_joint_whose_friction_takes_its_torque_is_named(tmp_path):
    room_of(of_text(tmp_path, -120, 120, friction=1.5))
    with pytest.raises(InfeasibleError, match=r"swing \(1\.7 of 2 Nm\)"):
        room_of(of_text(tmp_path, -120, 120, friction=1.7))
