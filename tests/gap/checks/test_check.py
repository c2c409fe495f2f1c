import json

import numpy as np
import pytest
from rig import rig_log, spoiled

from hyperleg_design.errors import InputError
from hyperleg_design.gap.checks.check import ROBOT, check_log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.model.file_subject import of_file
from hyperleg_design.gap.results.finding import ERROR, NOTE, WARNING

TORQUES = "motor_torque", "motor_torque_command", "motor_current"


def found(log, severity, subject=None):
    findings = check_log(log, subject).findings
    return [(f.signal, f.what) for f in findings if f.severity == severity]


def test_a_sound_log():
    check = check_log(rig_log())
    assert check.usable
    assert check.findings == ()
    assert check.sampling.rate == pytest.approx(200)
    assert check.column("position/hip").noise == pytest.approx(1e-4, rel=0.2)
    assert "coulomb_friction" in check.shown
    json.dumps(check.mapping(), allow_nan=False)


def test_what_every_log_needs():
    bare = spoiled(
        rig_log(gains={}),
        **{
            f"{kind}__{j}": None
            for kind in ("motor_torque_command", "motor_torque")
            for j in ("hip", "knee")
        },
    )
    assert found(bare, WARNING) == [
        ("position_target", "targets without gains say nothing of torques")
    ]
    bare = spoiled(bare, motor_current__hip=None, motor_current__knee=None)
    assert found(bare, ERROR) == [
        ("position_target", "targets without gains say nothing of torques")
    ]
    bare = spoiled(bare, position_target__hip=None, position_target__knee=None)
    assert found(bare, ERROR) == [("", "neither targets nor torques nor currents")]
    assert not check_log(bare).usable


def test_torques_without_targets_are_fine():
    names = {
        f"{kind}__{j}": None
        for kind in ("position_target", "motor_torque_command", "motor_current")
        for j in ("hip", "knee")
    }
    assert check_log(spoiled(rig_log(gains={}, torque_constant={}), **names)).findings == ()


def test_clock():
    log = rig_log()
    rng = np.random.default_rng(0)
    assert (
        "jitters by"
        in found(log.changed(time=log.time + rng.uniform(-0.0024, 0.0024, 4000)), NOTE)[0][1]
    )
    late = log.time + np.where(np.arange(4000) > 2000, 1.0, 0.0)
    assert "lost in dropouts, the longest 1" in found(log.changed(time=late), WARNING)[0][1]
    assert "is short" in found(log.part(slice(0, 150)), WARNING)[0][1]
    assert "friction at reversals" in found(log.part(slice(0, 4000, 8)), WARNING)[0][1]


def test_time_in_another_unit():
    log = rig_log()
    assert found(log.changed(time=log.time * 1e3), ERROR) == [
        ("t", "rows come every 5 s: the time looks like milliseconds")
    ]
    with pytest.raises(InputError, match=r"rig: t: rows come every 5 s.*; give it in seconds"):
        check_log(log.changed(time=log.time * 1e3)).refuse()
    check_log(log).refuse()


def test_two_rates_and_gaps():
    log = rig_log()
    every = np.arange(4000) % 5 == 0
    slow = spoiled(log, motor_torque__hip=lambda v: np.where(every, v, np.nan))
    assert found(slow, WARNING) == [("motor_torque/hip", "is given at 40 Hz in a log of 200 Hz")]
    held = spoiled(log, position_target__hip=lambda v: v[np.arange(4000) // 4 * 4])
    assert ("position_target/hip", "is held at 50 Hz in a log of 200 Hz") in found(held, NOTE)
    both = spoiled(held, position_target__knee=lambda v: v[np.arange(4000) // 4 * 4])
    assert found(both, NOTE) == [
        ("position_target", "is held at 50 Hz in a log of 200 Hz (2 columns)")
    ]
    lost = spoiled(
        log, position__hip=lambda v: np.where((log.time > 3) & (log.time < 5), np.nan, v)
    )
    assert any(
        s == "position/hip" and "10.0 % of its values are missing" in w
        for s, w in found(lost, WARNING)
    )
    empty = spoiled(log, motor_torque__hip=lambda v: v * np.nan)
    assert ("motor_torque/hip", "holds no values") in found(empty, WARNING)


def test_saturated_and_dead_channels():
    clipped = spoiled(rig_log(), motor_torque__hip=lambda v: np.clip(v, -0.5, 0.5))
    assert any(
        s == "motor_torque/hip" and "sits at a bound, -0.5 or 0.5" in w
        for s, w in found(clipped, WARNING)
    )
    dead = spoiled(rig_log(), motor_torque__hip=np.zeros_like)
    assert ("motor_torque/hip", "never changes from 0") in found(dead, WARNING)


def test_remarks_of_readers_are_told():
    log = rig_log()
    log = log.changed(metadata=log.metadata.remarked("the source lacks gains"))
    assert found(log, NOTE) == [("", "the source lacks gains")]


def test_errors_stand_first():
    log = spoiled(rig_log().changed(metadata=Metadata(remarks=("x",))), velocity__hip=np.degrees)
    ranks = [("error", "warning", "note").index(f.severity) for f in check_log(log).findings]
    assert ranks == sorted(ranks)
    assert ranks[0] == 0


def test_real_logs(real_logs):
    from hyperleg_design.gap.logs.readers import open_log

    for log in open_log(real_logs / "xl330_pendulum"):
        check = check_log(log)
        assert check.usable
        assert check.column("position/servo").quantum == pytest.approx(2 * np.pi / 4096, rel=1e-3)
        assert "controller_gain" in check.shown
        assert "payload" in check.shown
        assert (
            "voltage_sag" not in check.shown
        )  # the reader declares a supply: predictions follow the logged voltage
        assert "thermal_derating" not in check.shown
    go2 = check_log(open_log(real_logs / "go2_air")[0])
    assert [f.signal for f in go2.errors] == ["position_target"]  # gains are not in the file


@pytest.fixture(scope="module")
def two_joints(tmp_path_factory):
    path = tmp_path_factory.mktemp("robot") / "two.xml"
    path.write_text(
        '<mujoco><worldbody><body><joint name="hip" axis="0 1 0" range="-90 90"/>'
        '<geom size="0.1"/><body pos="0 0 -0.3"><joint name="knee" axis="0 1 0" range="-90 90"/>'
        '<geom size="0.1"/></body></body></worldbody>'
        '<equality><joint joint1="hip" joint2="knee"/></equality></mujoco>'
    )
    return of_file(path, None, None)


def test_what_is_left_out_of_a_robots_file_is_told(two_joints):
    notes = [what for signal, what in found(rig_log(), NOTE, two_joints) if signal == ROBOT]
    assert notes == ["1 equality constraints (closed loops, mimic joints) are left out"]


def test_joints_whose_torque_no_signal_tells_are_told(two_joints):
    log = rig_log()
    assert not [what for _, what in found(log, NOTE, two_joints) if "is in no signal" in what]
    blind = spoiled(log, position_target__knee=None, **{f"{t}__knee": None for t in TORQUES})
    (note,) = (what for _, what in found(blind, NOTE, two_joints) if "is in no signal" in what)
    assert note.startswith("torque of knee is")
