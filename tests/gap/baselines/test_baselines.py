"""Fits of one servo: what was put into a simulation of another kind comes out of all three."""

import json
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.baselines import table
from hyperleg_design.gap.baselines.drive_set import drive_set
from hyperleg_design.gap.baselines.own import closed_loop_of, fit_own
from hyperleg_design.gap.baselines.pace import fit_pace
from hyperleg_design.gap.baselines.population import position_gap, predicted, squared_error
from hyperleg_design.gap.baselines.rollout import Rollout
from hyperleg_design.gap.baselines.sysid import fit_sysid
from hyperleg_design.gap.conditioning import condition
from hyperleg_design.gap.log import write_log
from hyperleg_design.gap.replay import replay, whole_log
from hyperleg_design.gap.rig_spec import rig_spec
from hyperleg_design.gap.subject import load_subject

SERVO = """
<mujoco model="servo">
  <option timestep="0.0005" integrator="implicitfast"/>
  <worldbody>
    <body name="arm" pos="0 0 1">
      <joint name="swing" axis="0 1 0" damping="{damping}" armature="{armature}" frictionloss="{friction}"/>
      <inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.0006 0.0006 0.0001"/>
    </body>
  </worldbody>
  <actuator><position name="swing" joint="swing" kp="6" kv="0.15"/></actuator>
</mujoco>
"""
NOMINAL = {"damping": 0.02, "armature": 0.003, "friction": 0.02}
WRONG = {"damping": 0.06, "armature": 0.006, "friction": 0.06}


def run(values, phase, **metadata):
    import robots

    def target(time):
        ramp = 1 - np.exp(-((time / 0.5) ** 2))
        return np.array([0.5 * ramp * (np.sin(2 * np.pi * 0.4 * time + phase) + 0.3 * np.sin(2 * np.pi * 2.1 * time + 2 * phase))])

    return robots.servo_run(SERVO.format(**values), target, 5.0, gains={"swing": (6.0, 0.15)}, **metadata)


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    path = tmp_path_factory.mktemp("servo") / "servo.xml"
    path.write_text(SERVO.format(**NOMINAL))
    logs = [run(WRONG, phase) for phase in (0.0, 1.0, 2.0)]
    # PACE's logs hold no torques
    logs = [log.changed(signals={c: v for c, v in log.signals.items() if not c.startswith("motor_torque")}) for log in logs]
    subject = load_subject(str(path), logs)
    signals = [condition(log, subject) for log in logs]
    return SimpleNamespace(path=path, logs=logs, signals=signals, drives=drive_set(signals[0].subject, signals[0].step))


def truth(drives):
    return np.array([WRONG[k] - NOMINAL[k] for k in ("armature", "damping", "friction")] + [0.0, 0.0])


def held_out(rig, values):
    return float(position_gap(rig.signals[2:], rig.drives, values)[0])


def test_simulators_agree_with_each_other_and_with_the_replay(rig):
    one, nothing = rig.signals[0], np.zeros(rig.drives.count)
    ours = predicted(one, rig.drives, nothing)[0]
    assert np.allclose(ours, replay(one, windows=whole_log(one)).position[0, 0], atol=1e-9)
    theirs = Rollout(one, rig.drives).positions(nothing)
    assert np.sqrt(np.mean((ours - theirs) ** 2)) < 0.15 * np.sqrt(np.mean((one.position[whole_log(one).ticks[0]] - ours) ** 2))


def test_truth_closes_the_gap(rig):
    nothing = np.zeros(rig.drives.count)
    assert held_out(rig, truth(rig.drives)) < 0.2 * held_out(rig, nothing)


def test_rows_of_a_population_do_not_touch_each_other(rig):
    one = rig.signals[0]
    several = np.stack([np.zeros(rig.drives.count), truth(rig.drives), 0.3 * rig.drives.high])
    together = predicted(one, rig.drives, several)
    assert np.allclose(together[1], predicted(one, rig.drives, several[1:2])[0], atol=1e-12)
    errors = squared_error(one, together)
    assert errors[1] < errors[0] < errors[2]


def test_a_diverged_simulation_costs_infinitely_much(rig):
    lost = np.full((1, *rig.signals[0].position[whole_log(rig.signals[0]).ticks[0]].shape), np.nan)
    assert squared_error(rig.signals[0], lost) == np.inf


def test_delay_moves_the_prediction_by_that_time(rig):
    one = rig.signals[0]
    late = np.zeros((2, rig.drives.count))
    late[1, -1] = 0.02
    before, after = predicted(one, rig.drives, late)[:, :, 0]
    ticks = round(0.02 / one.step)
    assert np.abs(after[ticks:] - before[:-ticks]).max() < 0.1 * np.abs(after - before).max()


def test_spec_has_the_dynamics_of_the_subject(rig):
    model = rig_spec(rig.signals[0].subject, 0.001).compile()
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = 0.7, 0.3
    mujoco.mj_forward(model, data)
    gravity = 0.5 * 9.81 * 0.1 * np.sin(0.7)
    assert abs(data.qfrc_bias[0]) == pytest.approx(gravity, rel=1e-9)
    inertia = np.zeros((1, 1))
    mujoco.mj_fullM(model, data, inertia)
    assert inertia[0, 0] == pytest.approx(0.0006 + 0.5 * 0.1**2 + 0.003, rel=1e-9)


def test_closed_loop_response_is_that_of_a_simulation(rig):
    one = rig.signals[0]
    values = np.zeros(rig.drives.count)
    loop = closed_loop_of(one, rig.drives, values)
    held = loop.response(np.ones((len(loop.damping), 1, 1)))[-1, 0, 0]
    posture = one.position[-1, 0]
    assert held == pytest.approx(1 / (6 + 0.5 * 9.81 * 0.1 * np.cos(posture)), rel=0.05)


def test_own_fit_finds_what_was_put_in(rig):
    found = fit_own(rig.signals[:2], rig.drives)
    assert held_out(rig, found.values) < 0.2 * held_out(rig, 0 * found.values)
    assert found.values[:3] == pytest.approx(truth(rig.drives)[:3], rel=0.3)
    assert abs(found.values[3]) < 0.01
    assert found.values[4] < 0.003


def test_sysid_finds_it_too_with_a_simulation_a_parameter(rig):
    pytest.importorskip("mujoco.sysid._src.optimize", reason="needs mujoco[sysid]: the extra baselines")
    found = fit_sysid(rig.signals[:2], rig.drives)
    own = fit_own(rig.signals[:2], rig.drives)
    assert held_out(rig, found.values) < 0.25 * held_out(rig, 0 * found.values)
    assert held_out(rig, own.values) < 1.3 * held_out(rig, found.values)
    assert found.evaluations > 3 * own.evaluations


def test_pace_gets_better_and_stays_within_bounds(rig):
    pytest.importorskip("cma", reason="needs cma: the extra baselines")
    short = [condition(log.part(slice(0, 300)), rig.signals[0].subject) for log in rig.logs[:1]]
    found = fit_pace(short, rig.drives, generations=12, population=10)
    again = fit_pace(short, rig.drives, generations=12, population=10)
    assert np.array_equal(found.values, again.values)
    assert (found.values >= rig.drives.low).all()
    assert (found.values <= rig.drives.high).all()
    first, last = (float(position_gap(short, rig.drives, v)[0]) for v in (found.history[0][1], found.values))
    assert last < first
    assert found.evaluations == 120


def test_cause_is_the_largest_change_over_its_usual_error(rig):
    values = np.zeros(rig.drives.count)
    values[2], values[3] = 5 * rig.drives.spread[2], -2 * rig.drives.spread[3]
    assert rig.drives.cause(values) == ("coulomb_friction", "swing", pytest.approx(5.0))
    values[-1] = 20 * rig.drives.spread[-1]
    assert rig.drives.cause(values)[:2] == ("command_delay", "robot")


def test_logs_without_targets_and_floating_bases_are_refused(rig):
    bare = rig.logs[0].changed(signals={c: v for c, v in rig.logs[0].signals.items() if not c.startswith("position_target")})
    torques = {"motor_torque/swing": np.zeros(len(bare.time))}
    signals = condition(bare.changed(signals={**bare.signals, **torques}), rig.signals[0].subject)
    for fit in (fit_own, fit_pace, fit_sysid):
        with pytest.raises(InputError, match="targets and gains"):
            fit([signals], rig.drives)
    with pytest.raises(InputError, match="fixed base"):
        drive_set(load_subject("hyperleg"), 0.005)


def trial_of(rig, folder):
    """A blind trial's folder with one case, as `trial` writes it."""
    case = folder / "cases" / "000"
    (case / "logs").mkdir(parents=True)
    for number, log in enumerate(rig.logs):
        write_log(case / "logs" / f"{number}.parquet", log.changed(metadata=log.metadata.changed(robot="robot.xml")))
    (case / "robot.xml").write_text(rig.path.read_text())
    (case / "case.json").write_text(json.dumps({"robot": "robot.xml", "logs": [f"logs/{i}.parquet" for i in range(3)], "references": []}))
    seal = {"sha256": "0" * 64, "cases": 1, "seed": 0, "plants": ["rig"], "duration": [5, 5]}
    (folder / "seal.json").write_text(json.dumps(seal))


def test_table_holds_gap_cause_and_time_and_leaves_the_key_alone(rig, tmp_path):
    trial_of(rig, tmp_path)
    found = table.baselines_table(tmp_path, methods=("diagnosis", "own"))
    own = next(e for e in found.entries if e.method == "own")
    assert own.right is None
    assert own.closed > 0.7
    assert own.effect in ("coulomb_friction", "viscous_friction", "rotor_inertia")
    assert next(e for e in found.entries if e.method == "diagnosis").stopped.startswith("no diagnosis")
    written = json.loads((tmp_path / "baselines.json").read_text())
    assert written["summary"][1]["method"] == "own"
    assert "sealed" in (tmp_path / "baselines.md").read_text()


def test_right_causes_count_also_by_their_other_names():
    truth = {"wrongs": [{"effect": "payload", "listed": True, "location": "hand", "also": ["wrist"]}]}
    assert table._right("payload", "wrist", truth)
    assert not table._right("payload", "elbow", truth)
    assert not table._right("", "", truth)
    assert table._right("", "", {"wrongs": []})
    assert not table._right("coulomb_friction", "wrist", {"wrongs": [{"effect": "torque_ripple", "listed": False}]})


@pytest.mark.parametrize(("methods", "cases"), [(("magic",), ()), ((), ()), (("own",), ("007",))])
def test_unknown_methods_and_cases_are_refused(rig, tmp_path, methods, cases):
    trial_of(rig, tmp_path)
    with pytest.raises(InputError):
        table.baselines_table(tmp_path, methods=methods, cases=cases)
