import json

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.readers import open_log
from hyperleg_design.gap.logs.readers.sage import SO101, SO101_JAW_RANGE


def write(folder, names=("hip", "knee"), ticks=100, control_step=0.02, sign=True):
    folder.mkdir()
    (folder / "joint_list.txt").write_text("\n".join(names) + "\n")

    def row(t, wave):
        return "[" + ", ".join(f"{wave(t + i):.6f}" for i in range(len(names))) + "]"

    times = [i * 0.02 for i in range(ticks)]
    states = [
        f'STATE_MOTOR,{t * 1e6},"{row(t, np.sin)}","{row(t, np.cos)}","{row(t, np.cos if sign else lambda x: abs(np.cos(x)))}"'  # noqa: E501
        for t in times
    ]
    (folder / "state_motor.csv").write_text(
        "type,timestamp,positions,velocities,torques\n" + "\n".join(states)
    )
    controls = [
        f'CONTROL,{i * control_step * 1e6},"{row(i * control_step, np.sin)}"'
        for i in range(int(ticks * 0.02 / control_step))
    ]
    (folder / "control.csv").write_text("type,timestamp,positions\n" + "\n".join(controls))
    return folder


def test_pairs(tmp_path):
    for source in (
        write(tmp_path / "run"),
        tmp_path / "run" / "state_motor.csv",
        tmp_path / "run" / "control.csv",
    ):
        (log,) = open_log(source)
        assert log.name == "run"
        assert log.joints == ("hip", "knee")
        np.testing.assert_allclose(log.time, np.arange(100) * 0.02)
        np.testing.assert_allclose(
            log.signals["position_target/knee"], np.sin(log.time + 1), atol=1e-6
        )
        np.testing.assert_allclose(log.signals["joint_torque/hip"], np.cos(log.time), atol=1e-6)
        assert any("lacks the controller's gains" in remark for remark in log.metadata.remarks)


def test_torques_without_sign_are_left_out(tmp_path):
    (log,) = open_log(write(tmp_path / "run", sign=False))
    assert not log.has("joint_torque", "hip")
    assert any("no sign" in remark for remark in log.metadata.remarks)


def test_targets_on_a_clock_of_their_own(tmp_path):
    (log,) = open_log(write(tmp_path / "run", control_step=0.0473))
    np.testing.assert_allclose(
        log.signals["position_target/hip"],
        np.sin(np.floor(log.time / 0.0473 + 1e-9) * 0.0473),
        atol=1e-5,
    )
    assert any("clock of their own" in remark for remark in log.metadata.remarks)


def test_side_file_in_the_folder(tmp_path):
    folder = write(tmp_path / "run")
    (folder / "hyperleg.json").write_text(json.dumps({"gains": {"hip": [5, 1]}, "session": "b"}))
    (log,) = open_log(folder)
    assert (log.metadata.gains, log.metadata.session) == ({"hip": (5, 1)}, "b")


def test_bad_tables(tmp_path):
    folder = write(tmp_path / "run")
    (folder / "joint_list.txt").write_text("one")
    with pytest.raises(InputError, match=r"joint_list.txt = 1: expects 2 names"):
        open_log(folder)
    (folder / "joint_list.txt").unlink()
    whole = (folder / "state_motor.csv").read_text()
    for text, message in (
        ("type,timestamp\n", "positions.*missing"),
        ("type,timestamp,positions\n", "empty log"),
        (
            'type,timestamp,positions\nS,0,"[1, 2]"\nS,1,"[1]"\n',
            r"positions, row 1 = 1: expects 2 values",
        ),
        ('type,timestamp,positions\nS,0,"[1, x]"\nS,1,"[1]"\n', r"positions, row 0 = '\[1, x\]'"),
        (whole[: len(whole) // 2 + 7], "row|table"),
    ):
        (folder / "state_motor.csv").write_text(text)
        with pytest.raises(InputError, match=message):
            open_log(folder)


def test_so101(real_logs):
    found = {log.name: log for log in open_log(real_logs / "so101_arm")}
    assert sorted(found) == ["chirp_sweep", "friction_gravity", "step_response", "triangle_wave"]
    for log in found.values():
        assert log.joints == SO101
        assert log.step == pytest.approx(0.02, rel=0.01)
        assert set(log.metadata.gains) == set(SO101)
    chirp = found["chirp_sweep"]
    # the jaw's 0 .. 1 and its speed in rad/s agree only after conversion
    rate = np.gradient(chirp.signals["position/Jaw"], chirp.time)
    assert np.polyfit(rate, chirp.signals["velocity/Jaw"], 1)[0] == pytest.approx(1, abs=0.05)
    assert SO101_JAW_RANGE > 2
