"""Robustness: each level changes what it says, and curves are means of what was measured."""

from __future__ import annotations

import pandas as pd
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.protocol import Steady, TTestProtocol, WalkProtocol
from hyperleg_design.evaluation.robustness import (
    CONDITIONS,
    _under,
    conditions_of,
    curves,
    robustness,
)
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.load import load_robot


def test_levels_change_the_robot_as_they_say():
    design = load_design()
    payload = CONDITIONS["payload"].setting(4.0).design(design)
    assert payload == {"pelvis.mass": design.pelvis.mass + 4.0}
    assert CONDITIONS["payload"].setting(0.0).design(design) == {}
    friction = CONDITIONS["joint_friction"].setting(1.1).design(design)
    assert friction["joints.knee.coulomb"] == pytest.approx(1.1 * 5.59)
    assert len(friction) == 14
    changed = design.with_values(friction)
    assert changed.joints.toe.viscous == pytest.approx(0.11)


def test_payload_and_friction_are_those_of_any_robot():
    design = load_robot("mini_cheetah")
    payload = CONDITIONS["payload"].setting(2.0).design(design)
    assert payload == {"links.trunk.mass": design["links.trunk.mass"] + 2.0}
    friction = CONDITIONS["joint_friction"].setting(1.2).design(design)
    assert set(friction) == {
        f"joints.{joint}.{kind}"
        for joint in ("abduction", "hip", "knee")
        for kind in ("coulomb", "viscous")
    }
    assert friction["joints.knee.coulomb"] == pytest.approx(1.2 * 0.2)


def test_friction_of_a_robot_without_friction_means_nothing():
    design = load_robot("mini_cheetah")
    smooth = design.with_values(CONDITIONS["joint_friction"].setting(0.0).design(design))
    assert "joint_friction" in conditions_of((), WalkProtocol(), [design])
    assert "joint_friction" not in conditions_of((), WalkProtocol(), [design, smooth])
    with pytest.raises(InputError, match=r"joint_friction.*mini_cheetah has no friction"):
        conditions_of(["joint_friction"], WalkProtocol(), [smooth])


def test_a_quadruped_under_a_payload():
    short = WalkProtocol(trials=2, distance=0.6, time_limit=1.2, steady=Steady(begin=0.3))
    table = robustness(
        ["walk_any-mini_cheetah-0"],
        ["payload"],
        protocol=short,
        levels={"payload": (0.0, 2.0)},
        workers=1,
    )
    assert table["trained"].tolist() == ["specialist"] * 2 + ["zero-shot"] * 2
    assert (table["joule_power"][2:].min()) > table["joule_power"][:2].max()
    assert {(p.variant, p.level) for p in curves(table)} == {
        ("mini_cheetah", 0.0),
        ("mini_cheetah", 2.0),
    }


def test_levels_change_the_protocol_as_they_say():
    protocol = WalkProtocol()
    slow = _under(protocol, CONDITIONS["speed"].setting(0.6))
    assert (slow.speed, slow.time_limit) == (0.6, pytest.approx(protocol.time_limit * 1.33 / 0.6))
    fast = _under(protocol, CONDITIONS["speed"].setting(2.0))
    assert fast.time_limit == protocol.time_limit
    assert _under(protocol, CONDITIONS["slope"].setting(3.0)).start.yaw == 0.0
    assert _under(protocol, CONDITIONS["push"].setting(0.4)).randomisation.push_speed == 0.4


@pytest.mark.parametrize("name", CONDITIONS)
def test_one_level_of_each_condition_is_the_protocols(name):
    nominal = {"speed": 1.33, "floor_friction": load_design().contact.friction}
    factors = ("joint_friction", "torque_constant")
    expected = nominal.get(name, 1.0 if name in factors else 0.0)
    assert expected in CONDITIONS[name].levels


def test_conditions_of_a_t_test_leave_walks_out():
    assert "slope" not in conditions_of((), TTestProtocol())
    assert list(CONDITIONS) == conditions_of((), WalkProtocol())
    with pytest.raises(InputError, match="it is of walks only; there are push"):
        conditions_of(["slope"], TTestProtocol())


def test_a_misspelt_condition_gets_the_nearest_one_that_fits():
    with pytest.raises(InputError, match=r"'joint_frction': did you mean joint_friction\?"):
        conditions_of(["joint_frction"], WalkProtocol())
    with pytest.raises(InputError, match="'slop': there are push, floor_friction"):
        conditions_of(["slop"], TTestProtocol())


def test_curves_count_all_trials_for_arrivals_and_arrivals_for_the_rest():
    rows = [
        {
            "condition": "push",
            "level": level,
            "variant": "toe",
            "design": "toe",
            "policy": f"p{seed}",
            "seed": seed,
            "outcome": "arrived" if trial or not level else "fell",
            "arrived": float(bool(trial or not level)),
            "steady_cost_of_transport": 0.3 + 0.1 * seed if trial or not level else 9.0,
        }
        for level in (0.0, 0.5)
        for seed in range(3)
        for trial in range(2)
    ]
    points = {(p.level, p.measure): p.estimate for p in curves(pd.DataFrame(rows))}
    assert points[0.0, "arrived"].mean == 1.0
    assert points[0.5, "arrived"].mean == pytest.approx(0.5)
    assert points[0.5, "steady_cost_of_transport"].mean == pytest.approx(0.4)
    assert points[0.5, "steady_cost_of_transport"].missing == 3


def test_a_short_case_from_policies_to_curves(make_onnx):
    """Policies that only stand: pushes and slopes change how they end, not that they are run."""
    policies = [make_onnx("first.onnx"), make_onnx("second.onnx", bias=0.01)]
    short = WalkProtocol(trials=2, distance=1.0, time_limit=0.8, steady=Steady(begin=0.5))
    table = robustness(
        policies,
        ["slope", "torque_constant"],
        protocol=short,
        levels={"slope": (0.0, 8.0), "torque_constant": (1.0, 0.5)},
        workers=1,
    )
    assert len(table) == 2 * 2 * 2 * 2
    assert set(table["condition"]) == {"slope", "torque_constant"}
    same = [
        table[(table["condition"] == c) & (table["level"] == level)]["power"].to_numpy()
        for c, level in (("torque_constant", 1.0), ("torque_constant", 0.5))
    ]
    assert (same[0] != same[1]).all()
    with pytest.raises(InputError, match="same policy"):
        robustness([policies[0], policies[0]], protocol=short)
