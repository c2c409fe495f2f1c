"""Where feet are, from recorded postures."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hyperleg_design.evaluation.rollout import Trial


def foot_places(trial: Trial, samples: np.ndarray) -> np.ndarray:
    """Compute where the feet stand on the floor at some samples of a trial.

    Args:
        trial: the recorded trial.
        samples: indices of the samples, `(k,)`.

    Returns:
        Mean position of the sole pads of each of the F feet in the world, x and y, `(k, F, 2)` [m].
    """
    import mujoco

    model = trial.model
    data = mujoco.MjData(model)
    pads = np.array([model.geom(pad).id for pad in trial.layout.pads])
    places = np.empty((len(samples), len(pads), 2))
    qpos = np.concatenate(
        [
            trial.base_position[samples],
            trial.base_orientation[samples],
            trial.joint_position[samples],
        ],
        -1,
    )
    for posture, place in zip(qpos, places, strict=True):
        data.qpos[:] = posture
        mujoco.mj_kinematics(model, data)
        place[:] = data.geom_xpos[pads, :2]
    feet = range(len(trial.layout.feet))
    return np.stack([places[:, trial.layout.pad_foot == foot].mean(1) for foot in feet], 1)
