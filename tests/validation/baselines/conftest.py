"""One servo: logs of a simulation of another kind, with other inertia and friction than the model
has.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.validation.baselines.drive_set import drive_set
from hyperleg_design.validation.baselines.population import position_gap

SERVO = """
<mujoco model="servo">
  <option timestep="0.0005" integrator="implicitfast"/>
  <worldbody>
    <body name="arm" pos="0 0 1">
      <joint name="swing" axis="0 1 0" damping="{damping}" armature="{armature}" frictionloss="{friction}"/>
      <inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.0006 0.0006 0.0001"/>
    </body>
  </worldbody>
  <actuator><position name="swing" joint="swing" kp="6" kv="0.15"/></actuator>
</mujoco>
"""  # noqa: E501
NOMINAL = {"damping": 0.02, "armature": 0.003, "friction": 0.02}
WRONG = {"damping": 0.06, "armature": 0.006, "friction": 0.06}


def run(values, phase, **metadata):
    import robots

    def target(time):
        ramp, angle = 1 - np.exp(-((time / 0.5) ** 2)), 2 * np.pi * time
        both = np.sin(0.4 * angle + phase) + 0.3 * np.sin(2.1 * angle + 2 * phase)
        return (0.5 * ramp * both)[:, None]

    return robots.servo_run(
        SERVO.format(**values), target, 5.0, gains={"swing": (6.0, 0.15)}, **metadata
    )


@pytest.fixture(scope="session")
def rig(tmp_path_factory):
    path = tmp_path_factory.mktemp("servo") / "servo.xml"
    path.write_text(SERVO.format(**NOMINAL))
    logs = [run(WRONG, phase) for phase in (0.0, 1.0, 2.0)]
    # PACE's logs hold no torques
    logs = [
        log.changed(
            signals={c: v for c, v in log.signals.items() if not c.startswith("motor_torque")}
        )
        for log in logs
    ]
    subject = load_subject(str(path), logs)
    signals = [condition(log, subject) for log in logs]
    drives = drive_set(signals[0].subject, signals[0].step)
    truth = np.array(
        [WRONG[k] - NOMINAL[k] for k in ("armature", "damping", "friction")] + [0.0, 0.0]
    )

    def held_out(values):
        return float(position_gap(signals[2:], drives, values)[0])

    return SimpleNamespace(
        path=path, logs=logs, signals=signals, drives=drives, truth=truth, held_out=held_out
    )
