import json

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.readers import open_log

torch = pytest.importorskip("torch")


def save(path, ticks=50, **more):
    time = torch.arange(ticks) * 0.005
    position = torch.stack([torch.sin(time), torch.cos(time)], -1)
    torch.save({"time": time, "dof_pos": position, "des_dof_pos": position + 0.1, **more}, path)
    return path


def test_positions_and_targets(tmp_path):
    (log,) = open_log(save(tmp_path / "traj.pt"))
    assert log.joints == ("joint_0", "joint_1")
    np.testing.assert_allclose(log.signals["position/joint_1"], np.cos(log.time), atol=1e-6)
    np.testing.assert_allclose(
        log.signals["position_target/joint_1"], np.cos(log.time) + 0.1, atol=1e-6
    )
    text = " ".join(log.metadata.remarks)
    assert "names no joints" in text
    assert "lacks velocities, torques" in text
    assert "lacks the controller's gains" in text


def test_side_file_names_joints_and_gains(tmp_path):
    (tmp_path / "traj.json").write_text(
        json.dumps({"joints": ["hip", "knee"], "gains": {"hip": [20, 1.5], "knee": [20, 1.5]}})
    )
    (log,) = open_log(save(tmp_path / "traj.pt", dof_vel=torch.zeros(50, 2)))
    assert log.joints == ("hip", "knee")
    assert log.has("velocity", "hip")
    assert log.metadata.gains["knee"] == (20, 1.5)
    assert not any("gains" in remark for remark in log.metadata.remarks)
    with pytest.raises(InputError, match="list of 2 names"):
        open_log(tmp_path / "traj.pt", metadata={"joints": ["hip"]})


def test_bad_files(tmp_path):
    with pytest.raises(InputError, match=r"des_dof_pos.*expects \(50, 2\)"):
        open_log(save(tmp_path / "traj.pt", des_dof_pos=torch.zeros(50, 3)))
    torch.save({"time": torch.zeros(3)}, tmp_path / "traj.pt")
    with pytest.raises(InputError, match=r"dof_pos.*missing"):
        open_log(tmp_path / "traj.pt")
    torch.save({"time": torch.zeros(3), "dof_pos": torch.zeros(4, 2)}, tmp_path / "traj.pt")
    with pytest.raises(InputError, match=r"expects \(3, joints\)"):
        open_log(tmp_path / "traj.pt")


def test_go2(real_logs):
    legs = [
        f"{leg}_{joint}_joint"
        for leg in ("FL", "FR", "RL", "RR")
        for joint in ("hip", "thigh", "calf")
    ]
    (log,) = open_log(
        real_logs / "go2_air" / "traj_0.pt",
        metadata={"joints": legs, "gains": {leg: [20, 1.5] for leg in legs}},
    )
    assert log.joints == tuple(legs)
    assert log.step == pytest.approx(0.005, rel=0.01)
    assert log.duration == pytest.approx(23.5, abs=0.1)
    assert log.metadata.gains["RR_calf_joint"] == (20, 1.5)
