"""Small robots as other people write MJCF, and how they are moved: six files of torque motors on
joints, gears or tendons.
"""

from __future__ import annotations

from dataclasses import dataclass

HEAD = """<mujoco model="{name}"><compiler angle="radian"/>
<option timestep="0.001" integrator="implicitfast"/>
<default><geom contype="0" conaffinity="0"/></default><worldbody>"""
TWO_LINK = """
<body name="post" pos="0 0 1"><geom type="box" size=".05 .05 .05" mass="4"/>
<body name="upper" pos="0 0 0"><joint name="shoulder" axis="0 1 0" range="-2.8 2.8"
 damping=".15" frictionloss=".3" armature=".02"/>
<geom type="capsule" fromto="0 0 0 0 0 -.35" size=".03" mass="1.6"/>
<body name="lower" pos="0 0 -.35"><joint name="elbow" axis="0 1 0" range="-2.6 2.6"
 damping=".08" frictionloss=".15" armature=".01"/>
<geom type="capsule" fromto="0 0 0 0 0 -.3" size=".025" mass=".9"/>
</body></body></body></worldbody>
<actuator><motor name="m_shoulder" joint="shoulder" ctrlrange="-25 25"/>
<motor name="m_elbow" joint="elbow" ctrlrange="-12 12"/></actuator></mujoco>"""
ARM = """
<body name="base" pos="0 0 .3"><geom type="cylinder" size=".05 .1" mass="3"/>
<body name="turret" pos="0 0 .12"><joint name="yaw" axis="0 0 1" range="-2.9 2.9"
 damping=".3" frictionloss=".4" armature=".05"/>
<geom type="capsule" fromto="0 0 0 0 0 .1" size=".045" mass="2.2"/>
<body name="upper" pos="0 0 .1"><joint name="shoulder" axis="0 1 0" range="-2 2"
 damping=".35" frictionloss=".5" armature=".06"/>
<geom type="capsule" fromto="0 0 0 0 0 .32" size=".04" mass="2.6"/>
<body name="fore" pos="0 0 .32"><joint name="elbow" axis="0 1 0" range="-2.5 2.5"
 damping=".2" frictionloss=".3" armature=".03"/>
<geom type="capsule" fromto="0 0 0 0 0 .27" size=".03" mass="1.4"/>
<body name="hand" pos="0 0 .27"><joint name="wrist" axis="0 1 0" range="-2 2"
 damping=".05" frictionloss=".08" armature=".01"/>
<geom type="box" size=".03 .03 .06" pos="0 0 .06" mass=".5"/>
</body></body></body></body></body></worldbody>
<actuator><motor name="m_yaw" joint="yaw" ctrlrange="-40 40"/>
<motor name="m_shoulder" joint="shoulder" ctrlrange="-60 60"/>
<motor name="m_elbow" joint="elbow" ctrlrange="-40 40"/>
<motor name="m_wrist" joint="wrist" ctrlrange="-12 12"/></actuator></mujoco>"""
LIMB = """
<body name="rig" pos="0 0 1.2"><geom type="box" size=".1 .1 .05" mass="5"/>
<body name="hip" pos="0 .05 -.05"><joint name="hip_roll" axis="1 0 0" range="-.6 .6"
 damping=".4" frictionloss=".6" armature=".08"/>
<geom type="box" size=".05 .04 .05" mass="1.5"/>
<body name="thigh" pos="0 0 -.06"><joint name="hip_pitch" axis="0 1 0" range="-1.6 1.6"
 damping=".5" frictionloss=".7" armature=".09"/>
<geom type="capsule" fromto="0 0 0 0 0 -.36" size=".05" mass="3.8"/>
<body name="shank" pos="0 0 -.36"><joint name="knee" axis="0 1 0" range="0 2.3"
 damping=".3" frictionloss=".5" armature=".05"/>
<geom type="capsule" fromto="0 0 0 0 0 -.36" size=".035" mass="1.9"/>
<body name="foot" pos="0 0 -.36"><joint name="ankle" axis="0 1 0" range="-.9 .9"
 damping=".12" frictionloss=".2" armature=".015"/>
<geom type="box" size=".1 .04 .015" pos=".03 0 -.04" mass=".8"/>
</body></body></body></body></body></worldbody>"""
HIPS = """
<motor name="m_roll" joint="hip_roll" gear="9" ctrlrange="-12 12"/>
<motor name="m_pitch" joint="hip_pitch" gear="9" ctrlrange="-12 12"/>"""
LEG = f"""{LIMB}
<actuator>{HIPS}<motor name="m_knee" joint="knee" gear="9" ctrlrange="-12 12"/>
<motor name="m_ankle" joint="ankle" gear="9" ctrlrange="-6 6"/></actuator></mujoco>"""
COUPLED = f"""{LIMB}
<tendon><fixed name="t_a"><joint joint="knee" coef="8"/><joint joint="ankle" coef="6"/></fixed>
<fixed name="t_b"><joint joint="knee" coef="8"/><joint joint="ankle" coef="-6"/></fixed></tendon>
<actuator>{HIPS}<motor name="m_a" tendon="t_a" ctrlrange="-8 8"/>
<motor name="m_b" tendon="t_b" ctrlrange="-8 8"/></actuator></mujoco>"""
SIX = """
<body name="base" pos="0 0 .1"><geom type="cylinder" size=".07 .1" mass="4"/>
<body name="one" pos="0 0 .1"><joint name="j1" axis="0 0 1" range="-3 3"
 damping=".8" frictionloss="1.5" armature=".25"/>
<geom type="cylinder" size=".06 .06" mass="3.5"/>
<body name="two" pos="0 .13 0"><joint name="j2" axis="0 1 0" range="-2.6 2.6"
 damping=".9" frictionloss="1.8" armature=".3"/>
<geom type="capsule" fromto="0 0 0 0 0 .42" size=".055" mass="7.5"/>
<body name="three" pos="0 -.11 .42"><joint name="j3" axis="0 1 0" range="-2.6 2.6"
 damping=".6" frictionloss="1.2" armature=".18"/>
<geom type="capsule" fromto="0 0 0 0 0 .39" size=".045" mass="2.6"/>
<body name="four" pos="0 0 .39"><joint name="j4" axis="0 1 0" range="-2.6 2.6"
 damping=".2" frictionloss=".4" armature=".04"/>
<geom type="cylinder" size=".045 .05" pos="0 .1 0" mass="1.3"/>
<body name="five" pos="0 .1 0"><joint name="j5" axis="0 0 1" range="-2.6 2.6"
 damping=".2" frictionloss=".35" armature=".04"/>
<geom type="cylinder" size=".045 .05" pos="0 0 .09" mass="1.3"/>
<body name="six" pos="0 0 .09"><joint name="j6" axis="0 1 0" range="-2.9 2.9"
 damping=".15" frictionloss=".3" armature=".03"/>
<geom type="box" size=".04 .05 .03" pos=".02 .1 0" mass=".9"/>
</body></body></body></body></body></body></body></worldbody>
<actuator><motor name="a1" joint="j1" ctrlrange="-160 160"/>
<motor name="a2" joint="j2" ctrlrange="-160 160"/><motor name="a3" joint="j3" ctrlrange="-120 120"/>
<motor name="a4" joint="j4" ctrlrange="-40 40"/><motor name="a5" joint="j5" ctrlrange="-40 40"/>
<motor name="a6" joint="j6" ctrlrange="-40 40"/></actuator></mujoco>"""
DOG_LEG = """
<body name="trunk" pos="0 0 .8"><geom type="box" size=".2 .1 .05" mass="6"/>
<body name="hip" pos=".19 .05 0"><joint name="abduction" axis="1 0 0" range="-.8 .8"
 damping=".1" frictionloss=".2" armature=".01"/>
<geom type="cylinder" size=".045 .02" mass=".7"/>
<body name="thigh" pos="0 .09 0"><joint name="swing" axis="0 1 0" range="-1.5 3"
 damping=".1" frictionloss=".2" armature=".01"/>
<geom type="capsule" fromto="0 0 0 0 0 -.21" size=".025" mass="1.1"/>
<body name="calf" pos="0 0 -.21"><joint name="knee" axis="0 1 0" range="-2.7 -.5"
 damping=".1" frictionloss=".25" armature=".016"/>
<geom type="capsule" fromto="0 0 0 0 0 -.21" size=".015" mass=".2"/>
<geom type="sphere" size=".022" pos="0 0 -.21" mass=".06"/>
</body></body></body></body></worldbody>
<actuator><motor name="abduction" joint="abduction" ctrlrange="-24 24"/>
<motor name="swing" joint="swing" ctrlrange="-24 24"/>
<motor name="knee" joint="knee" ctrlrange="-40 40"/></actuator></mujoco>"""


@dataclass(frozen=True)
class Robot:
    """An MJCF file and a controller; tuples hold a value a joint."""

    xml: str
    stiffness: tuple[float, ...]
    """[Nm/rad]."""
    damping: tuple[float, ...]
    """[Nms/rad]."""
    middle: tuple[float, ...]
    """Of the motion [rad]."""
    swing: tuple[float, ...]
    """Size of the motion [rad]."""
    lag: float = 0.0
    """Time constant of all drives, healthy ones, too, that the file does not tell [s]."""
    belts: float = 0.0
    """Frequency at which every rotor rings on its own transmission while the joint is held, healthy
    robots, too [Hz]; 0, all are rigid."""
    jitter: float = 0.0
    """Standard deviation of the stamps of a log [s]."""
    steps: bool = False
    """Whether targets jump, within 80 ms, where a pause ends."""


def _file(name: str, body: str) -> str:
    return HEAD.format(name=name) + body


_LEG_GAINS = ((150.0, 180.0, 150.0, 40.0), (5.0, 6.0, 5.0, 1.2))
_LEG_MOTION = ((0.0, -0.4, 0.8, -0.2), (0.25, 0.5, 0.6, 0.4))
ROBOTS = {
    "two_link": Robot(_file("two_link", TWO_LINK), (60, 25), (2.5, 1.0), (0.4, 0.5), (0.9, 1.0)),
    "dog_leg": Robot(
        _file("dog_leg", DOG_LEG), (60, 60, 60), (1.5, 1.5, 1.5), (0, 0.8, -1.6), (0.4, 0.7, 0.7)
    ),
    "six": Robot(
        _file("six", SIX),
        (900, 1200, 700, 100, 80, 40),
        (45, 60, 35, 5, 4, 2),
        (0, 0.4, 0.8, 0.3, 0, 0),
        (0.9, 0.5, 0.7, 0.8, 0.9, 1.0),
        lag=0.003,
        belts=45.0,
        jitter=1e-4,
    ),
    "arm": Robot(
        _file("arm", ARM),
        (60, 120, 70, 12),
        (3, 6, 3, 0.5),
        (0, 0.5, 0.7, 0),
        (0.9, 0.7, 0.8, 0.6),
        steps=True,
    ),
    "leg": Robot(_file("leg", LEG), *_LEG_GAINS, *_LEG_MOTION, steps=True),
    "coupled": Robot(_file("coupled", COUPLED), *_LEG_GAINS, *_LEG_MOTION, steps=True),
}
"""By name."""
