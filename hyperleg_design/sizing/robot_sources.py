"""Where other robots' descriptions are, and what their legs are called there."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class RobotSource:
    """Where one robot's description is, and what its leg is called there. Names and numbers are the
    description's own.
    """

    name: str
    """Name in figures."""
    kind: str
    """`biped`, `quadruped` or `human`."""
    file: str
    """Below the folder of robots, URDF or SDF."""
    first_hip: str
    """Joint between trunk and leg."""
    hip_pitch: str
    """Joint that swings the leg fore and aft."""
    knee: str
    """Joint of the knee."""
    ankle: str
    """Joint of the ankle's pitch; empty where there is none."""
    foot: str
    """Link or frame in which `sole` is given."""
    sole: tuple[float, float, float]
    """A point of the sole under the ankle, or the centre of a round foot [m]."""
    foot_radius: float = 0.0
    """Radius of a round foot, below its centre [m]."""
    legs: int = 2
    whole: bool = True
    """Whether the description has the whole robot; the total mass is unknown otherwise."""


SOURCES = (
    # sole: pads of 5 mm radius, 30 mm below the ankle roll's frame
    RobotSource(
        name="Unitree G1",
        kind="biped",
        file="g1_description/urdf/g1_29dof_rev_1_0.urdf",
        first_hip="left_hip_pitch_joint",
        hip_pitch="left_hip_pitch_joint",
        knee="left_knee_joint",
        ankle="left_ankle_pitch_joint",
        foot="left_ankle_roll_link",
        sole=(0.0, 0.0, -0.03),
        foot_radius=0.005,
    ),
    # closed by rods; sole: axis of the capsule-like cylinder of the foot. This file has rotors and
    # gears in their links
    RobotSource(
        name="Cassie",
        kind="biped",
        file="cassie_description/robots/cassie_v2.sdf",
        first_hip="left-roll-op",
        hip_pitch="left-pitch-op",
        knee="left-knee-op",
        ankle="left-foot-op",
        foot="left-foot",
        sole=(0.01, 0.045, 0.0),
        foot_radius=0.0168,
    ),
    RobotSource(
        name="Talos",
        kind="biped",
        file="talos_data/robots/talos_full_v2.urdf",
        first_hip="leg_left_1_joint",
        hip_pitch="leg_left_3_joint",
        knee="leg_left_4_joint",
        ankle="leg_left_5_joint",
        foot="left_sole_link",
        sole=(0.0, 0.0, 0.0),
    ),
    RobotSource(
        name="iCub",
        kind="biped",
        file="icub_description/robots/icub.urdf",
        first_hip="l_hip_pitch",
        hip_pitch="l_hip_pitch",
        knee="l_knee",
        ankle="l_ankle_pitch",
        foot="l_sole",
        sole=(0.0, 0.0, 0.0),
    ),
    RobotSource(
        name="Romeo",
        kind="biped",
        file="romeo_description/urdf/romeo.urdf",
        first_hip="LHipYaw",
        hip_pitch="LHipPitch",
        knee="LKneePitch",
        ankle="LAnklePitch",
        foot="l_sole",
        sole=(0.0, 0.0, 0.0),
    ),
    # legs and pelvis only; sole: lowest point of the foot's mesh
    RobotSource(
        name="Alexander",
        kind="biped",
        file="alexander_description/urdf/alexander_v1.lowerBodyOnly.urdf",
        first_hip="LEFT_HIP_X",
        hip_pitch="LEFT_HIP_Y",
        knee="LEFT_KNEE_Y",
        ankle="LEFT_ANKLE_Y",
        foot="LEFT_FOOT",
        sole=(0.0, 0.0, -0.072),
        whole=False,
    ),
    # foot without mass; its mesh is a ring of 16 mm radius
    RobotSource(
        name="Bolt",
        kind="biped",
        file="bolt_description/robots/bolt.urdf",
        first_hip="FL_HAA",
        hip_pitch="FL_HFE",
        knee="FL_KFE",
        ankle="",
        foot="FL_FOOT",
        sole=(0.0, 0.0, 0.0),
        foot_radius=0.016,
    ),
    # y points up; sole: lowest point of the foot's mesh
    RobotSource(
        name="Human",
        kind="human",
        file="human_description/robots/human.urdf",
        first_hip="left_hip_Z",
        hip_pitch="left_hip_Z",
        knee="left_knee_Z",
        ankle="left_ankle_Z",
        foot="left_foot",
        sole=(0.0, -0.0765, 0.0),
    ),
    # lowest point of the foot's mesh is 22.9 mm below its centre
    RobotSource(
        name="Unitree Go2",
        kind="quadruped",
        file="go2_description/urdf/go2.urdf",
        first_hip="FL_hip_joint",
        hip_pitch="FL_thigh_joint",
        knee="FL_calf_joint",
        ankle="",
        foot="FL_foot",
        sole=(0.0, 0.0, 0.0),
        foot_radius=0.0229,
        legs=4,
    ),
    RobotSource(
        name="ANYmal C",
        kind="quadruped",
        file="anymal_c_simple_description/urdf/anymal.urdf",
        first_hip="LF_HAA",
        hip_pitch="LF_HFE",
        knee="LF_KFE",
        ankle="",
        foot="LF_FOOT",
        sole=(0.0, 0.0, 0.0225),
        foot_radius=0.03,
        legs=4,
    ),
    RobotSource(
        name="Solo12",
        kind="quadruped",
        file="solo_description/robots/solo12.urdf",
        first_hip="FL_HAA",
        hip_pitch="FL_HFE",
        knee="FL_KFE",
        ankle="",
        foot="FL_FOOT",
        sole=(0.0, 0.0, 0.0),
        foot_radius=0.016,
        legs=4,
    ),
)
"""Robots to compare with."""
