import json

import numpy as np
import pytest
from rig import rig_log, spoiled

from hyperleg_design import cli
from hyperleg_design.errors import InputError
from hyperleg_design.gap.checks.checking import check_sources
from hyperleg_design.gap.logs.log import read_log, write_log


def test_logs_are_checked_and_converted(tmp_path):
    (tmp_path / "a.csv").write_text(
        "stamp,q1\n" + "".join(f"{i * 0.01},{np.sin(i * 0.01)}\n" for i in range(500))
    )
    checks = check_sources(
        [tmp_path / "a.csv"], mapping=["stamp=t", "q1=position/knee"], out=tmp_path / "out"
    )
    assert [c.name for c in checks] == ["a"]
    assert not checks[0].usable  # no target, no torque
    (content,) = json.loads((tmp_path / "out" / "check.json").read_text())
    assert content["usable"] is False
    np.testing.assert_allclose(
        read_log(tmp_path / "out" / "a.parquet").signals["position/knee"],
        np.sin(np.arange(500) * 0.01),
    )


def test_names_of_files_are_kept_apart(tmp_path):
    for folder in ("x", "y"):
        write_log(tmp_path / folder / "run.parquet", rig_log())
    checks = check_sources([tmp_path / "x", tmp_path / "y"], out=tmp_path / "out")
    assert [c.name for c in checks] == ["run", "run"]
    assert sorted(p.name for p in (tmp_path / "out").glob("*.parquet")) == [
        "run.parquet",
        "run_1.parquet",
    ]


def test_the_robot_that_a_log_names_is_found_beside_it(tmp_path, robot_files):
    (tmp_path / "robot.xml").write_text(robot_files["pendulum"].read_text())
    write_log(tmp_path / "run.parquet", rig_log(robot="robot.xml"))
    (check,) = check_sources([tmp_path / "run.parquet"])
    assert "another robot" in check.errors[0].what


def test_logs_of_another_robot_are_told(tmp_path):
    write_log(tmp_path / "run.parquet", rig_log())
    (check,) = check_sources([tmp_path / "run.parquet"], robot="hyperleg")
    assert not check.usable
    assert "another robot" in check.errors[0].what
    with pytest.raises(InputError, match=r"no\.xml"):
        check_sources([tmp_path / "run.parquet"], robot="no.xml")


def test_bad_requests(tmp_path):
    with pytest.raises(InputError, match="expects files"):
        check_sources([])
    write_log(tmp_path / "run.parquet", rig_log())
    with pytest.raises(InputError, match="THEIRS=OURS"):
        check_sources([tmp_path / "run.parquet"], mapping=["q1"])


def test_command_line(tmp_path, capsys):
    path = write_log(tmp_path / "run.parquet", rig_log())
    assert cli.main(["gap", "check", str(path)]) == 0
    text = capsys.readouterr().out
    assert "run: 20 s at 200 Hz" in text
    assert "fit for a diagnosis" in text
    assert "cannot  thermal_derating: no motor temperature" in text
    write_log(path, spoiled(rig_log(), velocity__hip=np.degrees))
    assert cli.main(["gap", "check", str(path), "--json"]) == 2
    (content,) = json.loads(capsys.readouterr().out)
    assert content["findings"][0]["signal"] == "velocity/hip"
    path.write_bytes(path.read_bytes()[:1000])
    assert cli.main(["gap", "check", str(path), "--out", str(tmp_path / "out")]) == 2
    assert "no whole Parquet file" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_simulation_passes_the_check_against_its_own_robot(tmp_path):
    from recorded import log_of_recording

    from hyperleg_design.robot.design import load_design
    from hyperleg_design.simulation.environment import Environment
    from hyperleg_design.simulation.rollout import rollout
    from hyperleg_design.simulation.tasks import load_task

    environment = Environment(load_design(), load_task("walk"), simulations=1, threads=1)
    steps = iter(range(200))
    recording = rollout(
        environment, lambda o: np.full((1, 14), 0.2 * np.sin(0.3 * next(steps))), 120
    )
    path = write_log(tmp_path / "run.parquet", log_of_recording(environment, recording))
    (check,) = check_sources([path])
    assert check.usable
    assert not [f for f in check.findings if "robot" in f.what or "swapped" in f.remedy]
