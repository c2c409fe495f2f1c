"""Shared: evaluations of planned walks whose numbers are known, T-test runs along the course, and a
folder of small trainings.
"""

from __future__ import annotations

import dataclasses
import json
import sys

import numpy as np
import pytest

from hyperleg_design.evaluation.protocol import TTestProtocol, WalkProtocol
from hyperleg_design.evaluation.protocols.t_test import measure_t_test
from hyperleg_design.evaluation.protocols.walk import measure_walk
from hyperleg_design.evaluation.result import evaluation_of
from hyperleg_design.evaluation.rollout import ARRIVED, FELL, Trial
from hyperleg_design.evaluation.shipped import Shipped
from hyperleg_design.report.drawer import FIGURES, Drawer
from hyperleg_design.report.pictures import gif, picture
from hyperleg_design.report.walks.evaluated import Evaluated
from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.model import simulation_model
from hyperleg_design.simulation.tasks import load_task
from hyperleg_design.sizing.demand import demand
from hyperleg_design.sizing.motions.walk import walk
from hyperleg_design.writing import write_bytes

SAMPLES, STRIDES, STRIDE_TIME = 168, 20, 0.84
DESIGNS = ("toe", "toe_removed_matched")


@pytest.fixture(autouse=True)
def _closed_figures():
    """Close what a test has drawn."""
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


def planned_walk(design, turn=0.0):
    """`STRIDES` strides of the planned walk as if they had been simulated, into a direction
    [rad].
    """
    planned = demand(design, walk(design, samples=SAMPLES))
    motion = planned.motion

    def tiled(values):
        return np.tile(values, (STRIDES, *[1] * (np.ndim(values) - 1)))

    position = tiled(motion.q[:, :3])
    position[:, 0] += np.repeat(np.arange(STRIDES) * motion.distance, SAMPLES)
    cosine, sine = np.cos(turn), np.sin(turn)
    level = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    x, y, z, w = tiled(motion.q[:, 3:7]).T
    c, s = np.cos(turn / 2), np.sin(turn / 2)
    return Trial(
        design=design,
        layout=layout_of(design),
        model=simulation_model(design),
        time_step=0.005,
        substeps=4,
        outcome=ARRIVED,
        end_time=STRIDES * STRIDE_TIME,
        base_position=position @ level.T,
        base_orientation=np.stack([c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w], -1),
        base_velocity=tiled(motion.v[:, :3]) @ level.T,
        joint_position=tiled(motion.q[:, 7:]),
        joint_velocity=tiled(motion.v[:, 6:]),
        driven_joint_torque=tiled(planned.joint_torque.reshape(SAMPLES, -1)),
        motor_torque=tiled(planned.motor_torque.reshape(SAMPLES, -1)),
        motor_velocity=tiled(planned.motor_velocity.reshape(SAMPLES, -1)),
        pad_force=tiled(planned.allocation.contact_force) @ level.T,
        pad_slip=np.zeros((SAMPLES * STRIDES, planned.allocation.contact_force.shape[1])),
    )


@pytest.fixture(scope="session")
def walks():
    """One planned walk by design."""
    return {name: planned_walk(load_design(name)) for name in DESIGNS}


def evaluation(trial, protocol, name, seed, change=0.0, fallen=0):
    """Three trials, power and time changed by a share; the last ones have fallen."""
    measure = measure_t_test if isinstance(protocol, TTestProtocol) else measure_walk
    trials = [trial] * (3 - fallen) + [dataclasses.replace(trial, outcome=FELL)] * fallen
    measured = {one.outcome: measure(one, protocol) for one in trials}
    rows = [measured[one.outcome] for one in trials]
    measures = [dict(row[0]) for row in rows]
    for i, row in enumerate(measures):
        for key in ("power", "time"):
            row[key] *= 1 + change + 0.001 * i
    cycles = [row[2] for row in rows] if len(rows[0]) > 2 else []
    found = evaluation_of(
        lambda observation: observation,
        trial.design,
        protocol,
        trials,
        measures,
        [row[1] for row in rows],
        cycles,
    )
    return dataclasses.replace(
        found, policy=name, seed=seed, origin={"deviations": {"clock": "gait clock"}}
    )


@pytest.fixture(scope="session")
def course_run(walks):
    """A run along the T-test's course at 2 m/s: a planned walk whose pelvis is carried over the
    course.
    """
    trial, course = walks["toe"], TTestProtocol().course
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(course, axis=0), axis=-1))])
    way = np.minimum(2.0 * trial.time_step * np.arange(trial.samples), length[-1])
    place = np.stack([np.interp(way, length, course[:, k]) for k in (0, 1)], -1)
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (trial.samples, 1))
    height = trial.base_position[:, 2:]
    return dataclasses.replace(
        trial, base_position=np.concatenate([place, height], -1), base_orientation=upright
    )


@pytest.fixture(scope="session")
def found(walks, course_run, tmp_path_factory):
    """Three seeds of walks of both designs, 10 % less power with the toe, one fall; one T-test
    training with the toe.
    """
    place = tmp_path_factory.mktemp("found")
    policies, evaluations = [], []
    for design, trial in walks.items():
        for seed in range(3):
            policies.append(
                Shipped("walk", design, seed, 0, place / f"walk-{design}-{seed}" / "policy.onnx")
            )
            policies[-1].path.parent.mkdir()
            rows = [
                {
                    "steps": 1000 * k,
                    "speed": 0.1 * k,
                    "falls": 10.0 - k,
                    "assist": 1 - 0.1 * k,
                    "reward": k,
                }
                for k in range(11)
            ]
            (policies[-1].path.parent / "progress.jsonl").write_text(
                "".join(json.dumps(r) + "\n" for r in rows)
            )
            change = (-0.1 if design == "toe" else 0.0) + 0.01 * seed
            one = evaluation(
                trial,
                WalkProtocol(),
                policies[-1].name,
                seed,
                change,
                fallen=int(design == "toe" and seed == 2),
            )
            evaluations.append(one if seed == 0 else one.light(0))
    policies.append(Shipped("t_test", "toe", 0, 0, place / "t_test-toe-0" / "policy.onnx"))
    evaluations.append(evaluation(course_run, TTestProtocol(), policies[-1].name, 0))
    band = {
        d: {
            c: [
                e
                for p, e in zip(policies, evaluations, strict=True)
                if p.design == d and p.group == "walk"
            ]
            for c in (0.01, 0.02)
        }
        for d in DESIGNS
    }
    return Evaluated(
        policies,
        evaluations,
        ["walk_upright-toe-3", "walk_upright-toe-4", "t_test-toe_removed_matched-0"],
        band,
    )


@pytest.fixture(scope="session")
def courses(course_run, tmp_path_factory):
    """T-tests of three arms, two seeds of two policies each; arms and policies differ in time."""
    place = tmp_path_factory.mktemp("courses")
    policies, evaluations = [], []
    for arm, design in enumerate(("toe", "toe_locked", "toe_removed_matched")):
        for seed in range(2):
            for late in range(2):
                path = place / f"t_test_free-{design}-{seed}" / f"{late}.onnx"
                policies.append(Shipped("t_test_free", design, seed, late, path))
                change = 0.025 * arm + 0.01 * seed + 0.002 * late
                one = evaluation(course_run, TTestProtocol(), policies[-1].name, seed, change)
                evaluations.append(one if seed == late == 0 else one.light(0))
    return Evaluated(policies, evaluations)


@pytest.fixture
def draw(tmp_path, monkeypatch):
    """Draws figures into a folder of its own; animations and scenes, which other tests draw, are
    stubs.
    """
    monkeypatch.setattr(gif, "render_gif", lambda made, path: write_bytes(path, b"GIF89a"))
    monkeypatch.setattr(picture, "render", lambda scene, path: write_bytes(path, b"PNG"))
    (tmp_path / FIGURES).mkdir()
    return Drawer(tmp_path)


def flat(content):
    """Items of a part, lists among them opened."""
    for item in content:
        if isinstance(item, list):
            yield from flat(item)
        else:
            yield item


def of_kind(content, kind):
    """Items of a part that are tables, pictures or texts."""
    return [item for item in flat(content) if isinstance(item, kind)]


@pytest.fixture(scope="session")
def trainings(tmp_path_factory):
    """A folder of three trainings whose policies hold the default posture."""
    onnx = pytest.importorskip("onnx")
    from hyperleg_design.learning.resolved import task_mapping

    place = tmp_path_factory.mktemp("trainings")
    for name, kind in (
        ("walk_upright-toe-0", "walk"),
        ("walk_upright-toe-1", "walk"),
        ("walk_upright-toe_removed_matched-0", "walk"),
        ("t_test-toe-0", "goal"),
    ):
        design, task = load_design(name.split("-")[1]), load_task(kind)
        environment = Environment(design, task, simulations=1)
        columns, joints = environment.observation_columns["policy"], list(environment.layout.joints)
        environment.close()
        metadata = {
            "format": "hyperleg-policy-1",
            "columns": columns,
            "joints": joints,
            "task": task_mapping(task),
            "design": design.to_mapping(),
            "seed": name[-1],
            "steps": "1000",
            "deviations": task.deviations,
        }
        helper = onnx.helper
        graph = helper.make_graph(
            [helper.make_node("Gemm", ["observation", "w", "b"], ["action"])],
            "policy",
            [
                helper.make_tensor_value_info(
                    "observation", onnx.TensorProto.FLOAT, ["n", len(columns)]
                )
            ],
            [helper.make_tensor_value_info("action", onnx.TensorProto.FLOAT, ["n", len(joints)])],
            [
                onnx.numpy_helper.from_array(
                    np.zeros((len(columns), len(joints)), np.float32), "w"
                ),
                onnx.numpy_helper.from_array(np.zeros(len(joints), np.float32), "b"),
            ],
        )
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 18)])
        model.ir_version = 10
        helper.set_model_props(
            model, {k: v if isinstance(v, str) else json.dumps(v) for k, v in metadata.items()}
        )
        folder = place / name
        folder.mkdir()
        (folder / "policy.onnx").write_bytes(model.SerializeToString())
    return place
