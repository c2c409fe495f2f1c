"""Bare physics of robots with models of their own, in mujoco-uni-runtime and in MuJoCo's rollout.

mujoco-uni-runtime needs an older MuJoCo than this package, so this runs in an environment of its
own with `mujoco-uni-runtime` and the MuJoCo that it was built for, on what `variants.py` exported:

    python benchmarks/variants.py --designs 16 --distance 2 --export peer
    OTHER/bin/python benchmarks/variants_peer.py peer

Every robot has its own model, with the friction that it had at each moment. Times are processor
time of one thread for one simulation step of one robot.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import mujoco
import mujoco.rollout
import numpy as np
from mujoco_uni.batch_env import BatchEnvPool


def main() -> None:
    folder = Path(sys.argv[1])
    data = np.load(folder / "states.npz")
    texts = [path.read_text() for path in sorted(folder.glob("*.xml"), key=lambda p: int(p.stem))]
    substeps, count = int(data["substeps"]), len(data["design"])
    models = [mujoco.MjModel.from_xml_string(texts[i]) for i in data["design"]]
    scratch = mujoco.MjData(models[0])
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    size = mujoco.mj_stateSize(models[0], kind)
    spent = {"mujoco-uni-runtime": [], "mujoco.rollout": []}
    for moment in range(len(data["qpos"])):
        states = np.empty((count, size))
        for i, model in enumerate(models):
            model.dof_damping[:] = np.reshape(data["damping"][moment, i], model.nv)
            scratch.qpos[:], scratch.qvel[:] = data["qpos"][moment, i], data["qvel"][moment, i]
            mujoco.mj_getState(models[0], scratch, states[i], kind)
        control = np.repeat(data["ctrl"][moment][:, None], substeps, 1)
        pool = BatchEnvPool(models, nbatch=count, nthread=1)
        start = time.process_time()
        final = pool.step(states, nstep=substeps, control=control)
        spent["mujoco-uni-runtime"].append(time.process_time() - start)
        start = time.process_time()
        others, _ = mujoco.rollout.rollout(models, [scratch], states, control)
        spent["mujoco.rollout"].append(time.process_time() - start)
        difference = np.abs(np.reshape(final, (count, -1)) - others[:, -1]).max()
        assert difference < 1e-9, difference
    for name, times in spent.items():
        each = 1e6 * float(np.median(times)) / (count * substeps)
        print(f"{name} with MuJoCo {mujoco.__version__}: {each:.1f} us a step of a robot")


if __name__ == "__main__":
    main()
