"""One log replayed by MuJoCo's own servos and rollouts, with parameters of `drive_set` written
straight into the compiled model.
"""

from __future__ import annotations

import copy

import numpy as np

from hyperleg_design.gap.model.rig_spec import rig_spec
from hyperleg_design.gap.playback.windows import whole_log
from hyperleg_design.gap.signals.channels import held
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.validation.baselines.drive_set import DriveSet

STEP = 0.0025
"""Of the simulation at most [s], PACE's; implicit servos bear more than explicit ones."""


class Rollout:
    """Replays of one log.

    Args:
        signals: conditioned log with targets and gains, base fixed.
        drives: parameters of the robot.
    """

    def __init__(self, signals: Signals, drives: DriveSet) -> None:
        import mujoco

        self.signals, self.drives = signals, drives
        subject = drives.subject
        self.substeps = max(int(np.ceil(signals.step / STEP - 1e-9)), 1)
        self.step = signals.step / self.substeps
        self.model = rig_spec(subject, self.step).compile()
        self.data = mujoco.MjData(self.model)
        self.ticks = whole_log(signals).ticks[0]
        self.driven = np.flatnonzero(~subject.passive)
        assert signals.target is not None
        self.target = held(signals.target, subject.default)[self.ticks][:, self.driven]

    def positions(self, values: np.ndarray) -> np.ndarray:
        """As encoders tell them, from the first valid tick to the last `(T, n)` [rad]; values
        `(P,)`.

        Args:
            values: of the parameters `(P,)`.

        Returns:
            The positions `(T, n)` [rad].
        """
        import mujoco
        from mujoco import rollout

        drives, subject = self.drives, self.drives.subject
        model = copy.copy(self.model)
        model.dof_armature[:] += drives.part(values, "armature")
        model.dof_damping[:] = np.maximum(
            self.model.dof_damping + drives.part(values, "damping"), 0.0
        )
        model.dof_frictionloss[:] = np.maximum(
            self.model.dof_frictionloss + drives.part(values, "friction"), 0.0
        )
        bias = drives.part(values, "bias")
        model.actuator_biasprm[:, 0] = -subject.gains[self.driven, 0] * bias[self.driven]
        mujoco.mj_setConst(model, self.data)
        late = float(drives.part(values, "delay")) / self.step
        whole, part = int(late), late - int(late)
        steps = np.arange((len(self.ticks) - 1) * self.substeps)
        control = (1 - part) * self.target[np.maximum(steps - whole, 0) // self.substeps]
        control += part * self.target[np.maximum(steps - whole - 1, 0) // self.substeps]
        first = self.ticks[0]
        self.data.qpos[:] = self.signals.position[first] - bias
        self.data.qvel[:] = self.signals.velocity[first]
        self.data.time = 0.0
        size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        start = np.empty(size)
        mujoco.mj_getState(model, self.data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        state, _ = rollout.rollout(model, self.data, start[None], control[None])
        position = state[0, self.substeps - 1 :: self.substeps, 1 : 1 + model.nq]
        return np.concatenate([self.signals.position[first][None], position + bias])

    def error(self, values: np.ndarray) -> np.ndarray:
        """Logged less predicted positions, zero at ticks not fit for use `(T, n)` [rad].

        Args:
            values: of the parameters `(P,)`.

        Returns:
            The errors `(T, n)` [rad].
        """
        return np.where(
            self.signals.valid[self.ticks][:, None],
            self.signals.position[self.ticks] - self.positions(values),
            0.0,
        )
