"""Shared: a recorded trial made of a planned walk whose gait and power are known from elsewhere,
and small ONNX policies.
"""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from hyperleg_design.evaluation.rollout import ARRIVED, Trial
from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.model import simulation_model
from hyperleg_design.simulation.tasks import load_task
from hyperleg_design.sizing.demand import demand
from hyperleg_design.sizing.motions.walk import walk

STRIDES = 20
SAMPLES = 168
"""Of a planned stride of 0.84 s: 5 ms each, as simulated."""


@pytest.fixture(scope="session")
def design():
    return load_design()


@pytest.fixture(scope="session")
def planned(design):
    """Demand of the planned walk."""
    return demand(design, walk(design, samples=SAMPLES))


@pytest.fixture(scope="session")
def planned_trial(design, planned):
    """`STRIDES` strides of the planned walk as if they had been simulated."""
    motion, torque = planned.motion, planned.motor_torque.reshape(SAMPLES, -1)
    forward = np.repeat(np.arange(STRIDES) * motion.distance, SAMPLES)

    def tiled(values):
        return np.tile(values, (STRIDES, *[1] * (np.ndim(values) - 1)))

    position = tiled(motion.q[:, :3])
    position[:, 0] += forward
    return Trial(
        design=design,
        layout=layout_of(design),
        model=simulation_model(design),
        time_step=0.005,
        substeps=4,
        outcome=ARRIVED,
        end_time=STRIDES * 0.84,
        base_position=position,
        base_orientation=tiled(motion.q[:, [6, 3, 4, 5]]),
        base_velocity=tiled(motion.v[:, :3]),  # the pelvis is upright: its axes are the world's
        joint_position=tiled(motion.q[:, 7:]),
        joint_velocity=tiled(motion.v[:, 6:]),
        driven_joint_torque=tiled(planned.joint_torque.reshape(SAMPLES, -1)),
        motor_torque=tiled(torque),
        motor_velocity=tiled(planned.motor_velocity.reshape(SAMPLES, -1)),
        pad_force=tiled(planned.allocation.contact_force),
        pad_slip=tiled(np.where(planned.allocation.contact_force[..., 2] > 0, 0.01, 0.0)),
    )


@pytest.fixture(scope="session")
def turned_trial(planned_trial):
    """The same walk into another direction and from another place."""
    angle = 2.0
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    w, x, y, z = planned_trial.base_orientation.T
    c, s = np.cos(angle / 2), np.sin(angle / 2)
    return dataclasses.replace(
        planned_trial,
        base_position=planned_trial.base_position @ turn.T + [3.0, -4.0, 0.0],
        base_velocity=planned_trial.base_velocity @ turn.T,
        base_orientation=np.stack([c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w], -1),
        pad_force=planned_trial.pad_force @ turn.T,
    )


@pytest.fixture(scope="session")
def layout_of_walk(design):
    """Columns and joints of the walk task on the paper's robot."""
    environment = Environment(design, load_task("walk"), simulations=1)
    return environment.observation_columns["policy"], list(environment.layout.joints)


@pytest.fixture
def make_onnx(tmp_path, design, layout_of_walk):
    """Writes a linear ONNX policy; keywords replace metadata (None leaves a key out), `weight` and
    `bias` fill it.
    """
    onnx = pytest.importorskip("onnx")
    import yaml

    from hyperleg_design import resources

    columns, joints = layout_of_walk

    def made(name="small.onnx", weight=0.0, bias=0.0, **changes):
        size = len(columns)
        task = yaml.safe_load((resources.content_folder("sim") / "task_walk.yaml").read_text())
        metadata = {
            "format": "hyperleg-policy-1",
            "columns": columns,
            "joints": joints,
            "task": task,
            "design": design.to_mapping(),
            "seed": "3",
            "steps": "1000",
        } | changes
        helper = onnx.helper
        graph = helper.make_graph(
            [helper.make_node("Gemm", ["observation", "w", "b"], ["action"])],
            "policy",
            [helper.make_tensor_value_info("observation", onnx.TensorProto.FLOAT, ["n", size])],
            [helper.make_tensor_value_info("action", onnx.TensorProto.FLOAT, ["n", len(joints)])],
            [
                onnx.numpy_helper.from_array(np.full((size, len(joints)), weight, np.float32), "w"),
                onnx.numpy_helper.from_array(np.full(len(joints), bias, np.float32), "b"),
            ],
        )
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 18)])
        model.ir_version = 10
        helper.set_model_props(
            model,
            {
                k: v if isinstance(v, str) else json.dumps(v)
                for k, v in metadata.items()
                if v is not None
            },
        )
        path = tmp_path / name
        path.write_bytes(model.SerializeToString())
        return path

    return made
