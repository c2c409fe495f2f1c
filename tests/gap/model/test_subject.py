import numpy as np
import pytest

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.signals.loading import load_subject


def log_of(joints, **metadata):
    time = np.arange(50) * 0.01
    return Log("some", time, {f"position/{j}": np.sin(time) for j in joints}, Metadata(**metadata))


def test_payload_hangs_on_link_or_joint_and_is_no_part_of_the_next_log(robot_files):
    from hyperleg_design.gap.model.rigid import inverse_dynamics

    joints = load_subject(robot_files["arm"]).joints
    by_link = load_subject(
        robot_files["arm"], [log_of(joints, payload={"flange": (2.0, 0.0, 0.05, 0.0)})]
    )
    by_joint = load_subject(
        robot_files["arm"], [log_of(joints, payload={"wrist_3": (2.0, 0.0, 0.15, 0.0)})]
    )
    assert by_link.model.body_mass.sum() == pytest.approx(
        load_subject(robot_files["arm"]).model.body_mass.sum() + 2.0
    )
    q, v, a = np.random.default_rng(0).normal(size=(3, 4, 6))
    np.testing.assert_allclose(
        inverse_dynamics(by_link, q, v, a), inverse_dynamics(by_joint, q, v, a), atol=1e-9
    )
    light = by_link.declare(Metadata(gains={"elbow": (7.0, 1.0)}))
    assert light.model.body_mass.sum() == pytest.approx(by_link.model.body_mass.sum() - 2.0)
    assert light.gains[2].tolist() == [7.0, 1.0]
    assert by_link.gains[2].tolist() == [2000.0, 150.0]
