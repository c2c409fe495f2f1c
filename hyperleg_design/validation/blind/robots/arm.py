"""Two fixed-base robots as somebody else would write them: a seven-joint arm of torque motors
behind gears, and one position servo.
"""

from __future__ import annotations

ARM_MJCF = """<mujoco model="bench_arm">
  <compiler angle="degree" autolimits="true"/>
  <option timestep="0.002" gravity="0 0 -9.81"/>
  <default>
    <default class="large"><joint armature="0.35" damping="1.4" frictionloss="2.2"/><motor gear="100" ctrlrange="-1.5 1.5"/></default>
    <default class="middle"><joint armature="0.16" damping="0.8" frictionloss="1.3"/><motor gear="100" ctrlrange="-0.9 0.9"/></default>
    <default class="small"><joint armature="0.045" damping="0.3" frictionloss="0.55"/><motor gear="80" ctrlrange="-0.4 0.4"/></default>
  </default>
  <worldbody>
    <body name="pedestal" pos="0 0 0.4">
      <geom type="cylinder" size="0.08 0.1" pos="0 0 -0.1" contype="0" conaffinity="0" mass="0"/>
      <body name="turret" pos="0 0 0.08">
        <inertial pos="0 -0.012 0.055" mass="3.4" diaginertia="0.0132 0.0121 0.0098"/>
        <joint class="large" name="turn" axis="0 0 1" range="-165 165"/>
        <body name="upper_arm" pos="0 0.03 0.10" euler="0 90 0">
          <inertial pos="-0.16 0.045 0" mass="4.6" diaginertia="0.0105 0.0760 0.0752"/>
          <joint class="large" name="shoulder" axis="0 1 0" range="-110 110"/>
          <body name="upper_roll" pos="-0.20 0 0">
            <inertial pos="-0.06 0.01 0.004" mass="1.9" diaginertia="0.0031 0.0082 0.0080"/>
            <joint class="middle" name="twist" axis="1 0 0" range="-160 160"/>
            <body name="forearm" pos="-0.19 0 0">
              <inertial pos="-0.11 -0.03 0.01" mass="2.3" diaginertia="0.0038 0.0210 0.0207"/>
              <joint class="middle" name="elbow" axis="0 1 0" range="-130 130"/>
              <body name="wrist_yoke" pos="-0.24 0 0">
                <inertial pos="-0.03 0.006 0" mass="1.15" diaginertia="0.0011 0.0017 0.0016"/>
                <joint class="small" name="wrist_roll" axis="1 0 0" range="-170 170"/>
                <body name="wrist" pos="-0.09 0 0">
                  <inertial pos="-0.02 0 0.012" mass="0.95" diaginertia="0.0008 0.0010 0.0009"/>
                  <joint class="small" name="wrist_bend" axis="0 0 1" range="-115 115"/>
                  <body name="flange" pos="-0.07 0 0">
                    <inertial pos="-0.03 0.004 0.002" mass="0.48" diaginertia="0.0004 0.0005 0.0005"/>
                    <joint class="small" name="flange_turn" axis="1 0 0" range="-170 170"/>
                    <geom type="cylinder" size="0.03 0.02" euler="0 90 0" contype="0" conaffinity="0" mass="0"/>
                  </body>
                </body>
              </body>
            </body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor class="large" name="turn" joint="turn"/>
    <motor class="large" name="shoulder" joint="shoulder"/>
    <motor class="middle" name="twist" joint="twist"/>
    <motor class="middle" name="elbow" joint="elbow"/>
    <motor class="small" name="wrist_roll" joint="wrist_roll"/>
    <motor class="small" name="wrist_bend" joint="wrist_bend"/>
    <motor class="small" name="flange_turn" joint="flange_turn"/>
  </actuator>
</mujoco>
"""  # noqa: E501
"""Rotor inertia stands on the joints as `armature`, already multiplied by the squared ratio."""

SERVO_MJCF = """<mujoco model="servo_pendulum">
  <compiler angle="radian"/>
  <option timestep="0.002" gravity="0 0 -9.81"/>
  <worldbody>
    <body name="housing" pos="0 0 0.5">
      <geom type="box" size="0.02 0.02 0.02" contype="0" conaffinity="0" mass="0"/>
      <body name="arm">
        <inertial pos="0 0 -0.12" mass="0.62" diaginertia="0.0021 0.0021 0.00006"/>
        <joint name="swing" axis="0 1 0" range="-2.6 2.6" armature="0.0045" damping="0.02" frictionloss="0.05"/>
        <geom type="capsule" size="0.01" fromto="0 0 0 0 0 -0.15" contype="0" conaffinity="0" mass="0"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="swing" joint="swing" kp="6" kv="0.15" forcerange="-2.4 2.4"/>
  </actuator>
</mujoco>
"""  # noqa: E501
