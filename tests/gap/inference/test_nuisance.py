from dataclasses import replace

import diagnosed
import numpy as np
import pytest
import robots

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.joints.friction import VARIED
from hyperleg_design.gap.effects.strength import joint_strength
from hyperleg_design.gap.inference.nuisance import (
    OF_WAY,
    TURNOVER,
    UNLISTED,
    WAYS,
    nuisance_parameters,
)
from hyperleg_design.gap.inference.nuisance_traces import traces
from hyperleg_design.gap.signals.loading import load_subject


def test_every_error_belongs_to_the_catalogue_and_to_a_place_of_the_robot(signals, errors):
    for one in errors:
        assert one.spread > 0
        assert one.effect in (TURNOVER, *UNLISTED) or one.location in EFFECTS[one.effect].locations(
            signals.subject
        )


def test_friction_of_which_the_model_tells_nothing_turns_over_once_it_is_calibrated(
    signals,
):
    subject = signals.subject
    bare = replace(
        subject,
        coulomb=np.where(np.arange(len(subject.joints)) == subject.joints.index("knee"), 0.3, 0.0),
    )
    alone, calibrated = (
        nuisance_parameters(bare, signals.step),
        nuisance_parameters(bare, signals.step, calibrated=True),
    )
    known = {e.name for e in alone if e.effect != TURNOVER or e.location == "knee"}
    more = [e for e in calibrated if e.name not in known]
    expected = {
        (TURNOVER, joint, 1 + i)
        for joint in subject.joints
        if joint != "knee"
        for i in range(len(WAYS))
    }
    assert {(e.effect, e.location, e.parameter) for e in more} == expected
    strength = dict(zip(subject.joints, joint_strength(bare), strict=True))
    trace = next(
        t
        for e, t in zip(calibrated, traces(replace(signals, subject=bare), calibrated), strict=True)
        if e in more
    )
    assert 0 < np.abs(trace["motion"]).max() < OF_WAY * 0.001 * strength["hip"] * 2


@pytest.mark.parametrize("calibrated", [False, True])
def test_friction_that_a_robot_has_varies_by_a_share_of_it_though_the_model_has_none(
    signals, calibrated
):
    none = np.zeros(len(signals.subject.joints))
    bare = replace(signals.subject, coulomb=none, viscous=none)
    dry = replace(bare, coulomb=np.array([0.7, 0.0]), viscous=np.array([0.3, 0.0]))
    known, unknown = (
        {(e.effect, e.location, e.parameter): e.spread for e in found}
        for found in (
            nuisance_parameters(bare, signals.step, calibrated, rubbing=dry),
            nuisance_parameters(bare, signals.step, calibrated),
        )
    )
    assert known.keys() == unknown.keys()
    more = {name: known[name] - unknown[name] for name in known if known[name] != unknown[name]}
    for effect, size in (
        ("coulomb_friction", 0.7),
        ("stribeck_friction", 0.7),
        ("viscous_friction", 0.3),
    ):
        usual = EFFECTS[effect].model_spread * size
        varied = VARIED if calibrated else 1.0
        assert more.pop((effect, "hip", 0)) == pytest.approx(varied * usual)
        fault = (
            EFFECTS[effect].usual_errors(robot, signals.step)["hip"][0] for robot in (dry, bare)
        )
        assert next(fault) - next(fault) == pytest.approx(usual)
    assert not more


def test_usual_errors_are_smaller_than_usual_causes(signals, errors):
    for one in errors:
        if one.effect not in (TURNOVER, *UNLISTED, "controller_gain"):
            usual = EFFECTS[one.effect].usual(one.location, signals.subject)[one.parameter]
            assert one.spread < 0.7 * abs(usual), one.name


def test_a_joint_without_a_drive_has_no_belt(tmp_path):
    path = tmp_path / "passive.xml"
    path.write_text(
        robots.GEARED.replace('<motor name="b" joint="knee" gear="-6" ctrlrange="-8 8"/>', "")
    )
    log = robots.geared_run("joint", ("hip", "knee"))
    signals = diagnosed.conditioned(path, robots.without(log, "motor_velocity"))[0]
    assert signals.subject.passive.tolist() == [False, True]
    belts = [
        one.location
        for one in nuisance_parameters(signals.subject, signals.step)
        if one.effect == "stiff_belt"
    ]
    assert belts == ["hip"]


def test_masses_and_filters_of_drives_are_the_same_in_all_sessions(
    robot_files,
):
    subject = load_subject(str(robot_files["coupled"]), [])
    parameters = nuisance_parameters(subject, 0.005)
    steady = {parameter.effect for parameter in parameters if parameter.steady}
    assert {"speed_filtered", "back_emf", "link_mass", "rotor_inertia"} <= steady
    assert not steady & {"coulomb_friction", "torque_constant", "encoder_offset", "command_delay"}
