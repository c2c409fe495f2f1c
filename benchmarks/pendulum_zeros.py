"""How far the zeros of the encoders of the real double pendulum differ from recording to recording.

An independent check of the benchmark's truth: MuJoCo's inverse dynamics and one least-squares fit a
recording (both offsets, and of each joint Coulomb and viscous friction, a constant torque and a
rotor), without any code of the diagnosis.

Run: python benchmarks/pendulum_zeros.py [DATA]
"""

from __future__ import annotations

import sys
from pathlib import Path

import mujoco
import numpy as np
from scipy.signal import butter, filtfilt

from hyperleg_design.validation.real.a0 import DEVELOPMENT, FOLDER, MODEL, read_recording
from hyperleg_design.validation.real.a0_model import JOINTS, read_model
from hyperleg_design.validation.real.cases import data_folder

BAND, EVERY, SLOW, STEP = 6.0, 4, 0.1, 1e-3
"""Of the motion [Hz]; ticks from sample to sample; speed at which friction turns over [rad/s];
offset of finite differences [rad]."""


def needed(model: mujoco.MjModel, motion: tuple[np.ndarray, ...]) -> np.ndarray:
    """Torques of inverse dynamics `(t, 2)` [Nm] of positions, velocities and accelerations."""
    data, torques = mujoco.MjData(model), np.empty_like(motion[0])
    for row, (data.qpos[:], data.qvel[:], data.qacc[:]) in enumerate(zip(*motion, strict=True)):
        mujoco.mj_inverse(model, data)
        torques[row] = data.qfrc_inverse
    return torques


def offsets(folder: Path, name: str, model: mujoco.MjModel) -> tuple[np.ndarray, np.ndarray]:
    """Offsets of both encoders and their standard deviations `(2,)` [rad]."""
    log = read_recording(folder, name)
    step = float(np.median(np.diff(log.time)))
    smooth = butter(4, 2 * BAND * step)
    columns = {
        kind: np.stack([log.signals[f"{kind}/{joint}"] for joint in JOINTS], 1)
        for kind in ("position", "motor_torque")
    }
    position, torque = (filtfilt(*smooth, column, axis=0) for column in columns.values())
    velocity = np.gradient(position, step, axis=0)
    acceleration = np.gradient(velocity, step, axis=0)
    some = slice(50, -50, EVERY)
    motion = position[some], velocity[some], acceleration[some]
    base = needed(model, motion)
    rows = [
        (base - needed(model, (motion[0] + STEP * np.eye(2)[joint], *motion[1:]))) / STEP
        for joint in (0, 1)
    ]
    for joint in (0, 1):
        speed = motion[1][:, joint]
        for shape in (np.tanh(speed / SLOW), speed, np.ones_like(speed), motion[2][:, joint]):
            rows.append(shape[:, None] * np.eye(2)[joint])
    design = np.stack([row.ravel() for row in rows], 1)
    left = (torque[some] - base).ravel()
    fit, *_ = np.linalg.lstsq(design, left, rcond=None)
    noise = (left - design @ fit).reshape(-1, 2).std(0)
    independent = EVERY * step * 2 * BAND
    weight = np.tile(np.sqrt(independent) / noise, len(left) // 2)
    covariance = np.linalg.inv((design * weight[:, None]).T @ (design * weight[:, None]))
    fit = covariance @ (design * weight[:, None] ** 2).T @ left
    return fit[:2], np.sqrt(np.diag(covariance))[:2]


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else data_folder()) / FOLDER
    model = mujoco.MjModel.from_xml_string(read_model(folder / MODEL).mjcf())
    print(f"{'recording':<24}{'shoulder [rad]':>20}{'elbow [rad]':>20}")
    for name in sorted(DEVELOPMENT):
        value, deviation = offsets(folder, name, model)
        cells = (f"{v:.3f} ± {d:.3f}" for v, d in zip(value, deviation, strict=True))
        print(f"{name:<24}" + "".join(f"{cell:>20}" for cell in cells))


if __name__ == "__main__":
    main()
