"""Record logs of the desk arm: a plain MuJoCo loop stands in for the real arm.

Run: python examples/desk_arm/record.py FOLDER

Nothing of hyperleg_design takes part, so this file also shows how a rig of your own writes its
logs: one Parquet table a recording with a row a sample, and what does not change during the
recording in a JSON file beside it. The arm on the desk differs from `desk_arm.xml`:

- always, by what no drawing tells: masses 1 %, friction 5 %, and encoders 1 mrad off;
- in the `run` and `held_out` logs, by 0.25 Nm more friction in the elbow: a seal was replaced.

The diagnosis has to find the second, and must not be misled by the first.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import mujoco
import numpy as np
import pandas as pd

MODEL = Path(__file__).with_name("desk_arm.xml")
JOINTS = ("shoulder", "elbow")
STIFFNESS = np.array([60.0, 30.0])
"""Of the position controller [Nm/rad]."""
DAMPING = np.array([2.0, 0.8])
"""Of the position controller [Nms/rad]."""
TICK, SAMPLE = 0.001, 0.005
"""Steps of controller and simulation, and of the log [s]."""
DURATION = 10.0
"""Of a recording [s]."""
SEAL = 0.25
"""Friction that the new seal adds to the elbow [Nm]."""
ENCODER, SPEED, TORQUE = 1e-4, 5e-3, 2e-2
"""Standard deviations of the sensors' noise [rad, rad/s, Nm]."""
MOTIONS = {
    1: (
        ((0.25, 0.5, 0.0), (0.7, 0.25, 1.0), (1.6, 0.06, 2.0)),
        ((0.35, 0.6, 0.5), (0.9, 0.3, 2.5), (2.1, 0.06, 0.0)),
    ),
    2: (
        ((0.2, 0.6, 2.0), (0.8, 0.2, 0.0), (1.9, 0.05, 1.0)),
        ((0.45, 0.5, 1.5), (1.1, 0.3, 0.5), (1.5, 0.08, 2.2)),
    ),
    3: (
        ((0.3, 0.5, 1.0), (0.6, 0.3, 2.2), (1.4, 0.07, 0.4)),
        ((0.25, 0.7, 0.2), (1.0, 0.3, 1.3), (1.8, 0.07, 2.8)),
    ),
}
"""By number; for each joint waves of a frequency [Hz], an amplitude [rad] and a phase [rad]."""
RECORDINGS = (
    ("reference_1", 1, False),
    ("reference_2", 2, False),
    ("run_1", 1, True),
    ("run_2", 2, True),
    ("held_out", 3, True),
)
"""Name, motion, and whether the new seal is in. References repeat the motions of the runs."""


def target(motion: int, time: float) -> np.ndarray:
    """Positions that the controller follows [rad]; each motion begins gently."""
    rise = min(time, 1.0) ** 2 * (3 - 2 * min(time, 1.0))
    return rise * np.array(
        [
            sum(size * np.sin(2 * np.pi * f * time + phase) for f, size, phase in waves)
            for waves in MOTIONS[motion]
        ]
    )


def desk_arm(new_seal: bool) -> mujoco.MjModel:
    """The arm as it stands on the desk, not quite as it was drawn."""
    model = mujoco.MjModel.from_xml_path(str(MODEL))
    built = np.random.default_rng(7)
    model.body_mass[:] *= 1 + 0.01 * built.standard_normal(model.nbody)
    model.dof_frictionloss[:] *= 1 + 0.05 * built.standard_normal(model.nv)
    if new_seal:
        model.dof_frictionloss[JOINTS.index("elbow")] += SEAL
    return model


def record(motion: int, new_seal: bool, seed: int) -> pd.DataFrame:
    """Follow a motion and note what the sensors say, a row a sample."""
    noise = np.random.default_rng(seed)
    model = desk_arm(new_seal)
    data = mujoco.MjData(model)
    zero = 0.001 * np.random.default_rng(8).standard_normal(2)  # of the encoders [rad]
    every, rows = round(SAMPLE / TICK), []
    for tick in range(round(DURATION / TICK)):
        time = tick * TICK
        wanted = target(motion, time)
        position = data.qpos + zero + ENCODER * noise.standard_normal(2)
        speed = data.qvel + SPEED * noise.standard_normal(2)
        torque = STIFFNESS * (wanted - position) - DAMPING * speed
        data.ctrl[:] = np.clip(torque, *model.actuator_ctrlrange.T)
        if tick % every == 0:
            measured = data.ctrl + TORQUE * noise.standard_normal(2)
            rows.append([time, *wanted, *position, *speed, *measured])
        mujoco.mj_step(model, data)
    signals = ("position_target", "position", "velocity", "motor_torque")
    return pd.DataFrame(rows, columns=["t", *(f"{s}/{j}" for s in signals for j in JOINTS)])


def main(folder: Path) -> None:
    """Write all recordings and their metadata to a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for seed, (name, motion, new_seal) in enumerate(RECORDINGS):
        table = record(motion, new_seal, seed)
        table.to_parquet(folder / f"{name}.parquet")
        told = {
            "base": "fixed",
            "gains": {j: [k, d] for j, k, d in zip(JOINTS, STIFFNESS, DAMPING, strict=True)},
            "session": "after the new seal" if new_seal else "before",
        }
        (folder / f"{name}.json").write_text(json.dumps(told, indent=2))
        print(f"{folder / name}.parquet: motion {motion}, {DURATION:g} s, {len(table)} samples")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit("give the folder to write to: python examples/desk_arm/record.py FOLDER")
    main(Path(sys.argv[1]))
