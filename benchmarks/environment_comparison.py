"""Policy steps per second of the environment against the usual way to run many robots: one
Gymnasium environment a robot.

The same robot, physics and actuation stand in a plain `gymnasium.Env`, with the observation of 67
numbers and fewer reward terms than the environment computes, behind Gymnasium's `SyncVectorEnv` and
`AsyncVectorEnv` and Stable-Baselines3's `SubprocVecEnv`. Those that are not installed are left out.
All are timed in one run, in turn.

    python benchmarks/environment_comparison.py --threads 2
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

try:
    import gymnasium
except ImportError:
    raise SystemExit(
        "needs gymnasium (pip install gymnasium); stable-baselines3 too for SubprocVecEnv"
    ) from None

from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.drives import actuation
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.model import simulation_model
from hyperleg_design.simulation.tasks import load_task


class SingleRobot(gymnasium.Env):
    """One robot in plain MuJoCo."""

    def __init__(self) -> None:
        import mujoco

        design = load_design()
        self.layout, self.actuation, self.task = (
            layout_of(design),
            actuation.actuation_model(design),
            load_task("walk"),
        )
        self.model = simulation_model(design, self.task.physics)
        self.data = mujoco.MjData(self.model)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (67,), np.float32)
        self.action_space = gymnasium.spaces.Box(-10, 10, (14,), np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        import mujoco

        super().reset(seed=seed)
        mujoco.mj_resetDataKeyframe(self.model, self.data, 0)
        self.data.qpos[7:] += self.np_random.uniform(-0.05, 0.05, 14)
        self.action, self.previous, self.smoothed = np.zeros(14), np.zeros(14), np.zeros(14)
        return self._observed(), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        import mujoco

        data, model = self.data, self.actuation
        self.previous, self.action = self.action, np.asarray(action, float)
        self.smoothed = actuation.smoothed_action(self.smoothed, self.action, 0.2)
        target = (self.layout.default + 0.5 * self.smoothed).reshape(2, 7)
        power = 0.0
        for _ in range(4):
            position, velocity = data.qpos[7:].reshape(2, 7), data.qvel[6:].reshape(2, 7)
            speed = actuation.motor_speed(model.joint_from_motor, velocity)
            torque = actuation.driven_torque(
                model, actuation.controller_torque(model, target, position, velocity), speed
            )
            data.ctrl[:] = torque.ravel()
            self.model.dof_damping[6:] = actuation.friction_damping(
                model.coulomb, model.viscous, velocity, 0.1
            ).ravel()
            power += float((model.envelope.power_constant * torque**2 + torque * speed).sum())
            mujoco.mj_step(self.model, data)
        error = data.qvel[0] - 1.33
        fallen = bool(data.qpos[2] < 0.55)
        reward = (
            2.5 * np.exp(-error * error / 0.25)
            - 1e-4 * power / 4
            - 0.003 * float(((self.action - self.previous) ** 2).sum())
        )
        return self._observed(), float(0.02 * (reward - 200 * fallen)), fallen, False, {}

    def _observed(self) -> np.ndarray:
        data = self.data
        w, x, y, z = data.qpos[3:7]
        gravity = [2 * (w * y - x * z), -2 * (y * z + w * x), 2 * (x * x + y * y) - 1]
        parts = (
            data.qvel[3:6],
            gravity,
            [1.33, 0, 0],
            data.qpos[7:] - self.layout.default,
            data.qvel[6:],
            self.action,
            self.previous,
            [0.0, 1.0],
        )
        return np.concatenate(parts).astype(np.float32)


def timed(step: Callable[[np.ndarray], Any], count: int, seconds: float) -> float:
    """Policy steps per second over about so many seconds."""
    actions = np.random.default_rng(0).normal(size=(16, count, 14)).astype(np.float32) * 0.1
    for action in actions[:4]:
        step(action)
    steps, start = 0, time.perf_counter()
    while time.perf_counter() - start < seconds:
        step(actions[steps % 16])
        steps += 1
    return steps * count / (time.perf_counter() - start)


def others() -> dict[
    str, Callable[[], tuple[Callable[[np.ndarray], Any], int, Callable[[], None]]]
]:
    """Ways to run robots, as functions that give step, number of robots and close."""

    def made(kind: Any, count: int) -> Any:
        vector = kind([SingleRobot] * count)
        vector.reset()
        return vector.step, count, vector.close

    found: dict[str, Any] = {
        "Gymnasium SyncVectorEnv, 8": partial(made, gymnasium.vector.SyncVectorEnv, 8),
        "Gymnasium AsyncVectorEnv, 8": partial(made, gymnasium.vector.AsyncVectorEnv, 8),
        "Gymnasium AsyncVectorEnv, 16": partial(made, gymnasium.vector.AsyncVectorEnv, 16),
    }
    try:
        from stable_baselines3.common.vec_env import SubprocVecEnv
    except ImportError:
        return found
    found["Stable-Baselines3 SubprocVecEnv, 8"] = partial(made, SubprocVecEnv, 8)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--simulations", type=int, default=512)
    parser.add_argument("--seconds", type=float, default=4.0)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    environment = Environment(
        load_design(),
        load_task("walk"),
        simulations=options.simulations,
        seed=0,
        threads=options.threads,
    )
    environment.reset()
    speeds: dict[str, list[float]] = {}
    for _ in range(options.rounds):
        own = timed(environment.step, options.simulations, options.seconds)
        speeds.setdefault(
            f"this environment, {options.simulations} on {options.threads} threads", []
        ).append(own)
        for name, make in others().items():
            step, count, close = make()
            speeds.setdefault(name, []).append(timed(step, count, options.seconds))
            close()
    reference = np.array(next(iter(speeds.values())))
    for name, found in speeds.items():
        ratio = float(np.median(reference / np.array(found)))
        print(
            f"{name}: {np.median(found):.0f} policy steps/s"
            + (f"; this environment is {ratio:.1f} times as fast" if ratio != 1 else "")
        )


if __name__ == "__main__":
    main()
