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
    found = np.empty((len(samples), len(trial.layout.feet), 2))
    for i, sample in enumerate(samples):
        data.qpos[:3], data.qpos[3:7], data.qpos[7:] = (
            trial.base_position[sample],
            trial.base_orientation[sample],
            trial.joint_position[sample],
        )
        mujoco.mj_kinematics(model, data)
        places = data.geom_xpos[pads, :2]
        for foot in range(len(trial.layout.feet)):
            found[i, foot] = places[trial.layout.pad_foot == foot].mean(0)
    return found
