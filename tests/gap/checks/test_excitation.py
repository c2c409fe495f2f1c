from types import SimpleNamespace

import numpy as np
import pytest
from rig import rig_log, spoiled

from hyperleg_design.gap.checks.excitation import beside_sensors, excitation_of, motion_of
from hyperleg_design.gap.checks.rules import RULES
from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.excitation import Excitation
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata


def robot(**changes):
    """As much of a subject of two joints as this looks at."""
    tree = SimpleNamespace(
        count=2,
        hinge=np.ones(2, bool),
        chain=lambda joint: [joint],
        rotation=np.stack([np.eye(3)] * 2),
    )
    facts = {"joints": ("hip", "knee"), "motors": ("hip", "knee"), "motor_aliases": ("hip", "knee")}
    facts |= {"gains": np.full((2, 2), np.nan), "floating": False, "spring": np.zeros(2)}
    facts |= {"joint_from_motor": np.eye(2)}
    facts |= {"gravity": np.array([0.0, -9.81, 0.0]), "tree": tree}
    return SimpleNamespace(**facts | changes)


def of(log):
    return {e.effect: e for e in excitation_of(log)}


def test_every_effect_of_the_catalogue_is_told_once():
    assert [e.effect for e in excitation_of(rig_log())] == list(EFFECTS)


def test_a_rich_log():
    found = of(rig_log())
    for effect in (
        "coulomb_friction",
        "viscous_friction",
        "payload",
        "torque_constant",
        "controller_gain",
        "encoder_offset",
        "backlash",
    ):
        assert found[effect].shown, effect
        assert found[effect].where == ("hip", "knee")
    for effect, word in (
        ("thermal_derating", "temperature"),
        ("voltage_sag", "voltage"),
        ("imu_bias", "gyroscope"),
        ("ground_compliance", "contact"),
    ):
        assert not found[effect].shown
        assert word in found[effect].why
    assert "delay" in found["transmission_elasticity"].why


def test_torques_count_under_the_motors_own_names():
    log = rig_log()
    own = dict(zip(("hip", "knee"), ("m1", "m2"), strict=True))
    renamed = {}
    for name, values in log.signals.items():
        kind, _, joint = name.partition("/")
        renamed[f"{kind}/{own[joint]}" if kind.startswith("motor") else name] = values
    log = log.changed(signals=renamed)
    subject = robot(motor_aliases=("m1", "m2"))
    assert not motion_of(log, None).measured.any()
    assert motion_of(log, subject).measured.all()


def test_commands_of_coupled_motors_count_at_the_joints_that_they_move():
    log = rig_log()
    kept = {n: v for n, v in log.signals.items() if n.startswith("position/")}
    fast = np.sin(2 * np.pi * 12 * log.time)
    slow = np.sin(2 * np.pi * 0.3 * log.time)
    kept |= {"motor_torque_command/fast": fast, "motor_torque_command/slow": slow}
    motors, both = ("fast", "slow"), np.array([[1.0, 1.0], [0.0, 1.0]])
    subject = robot(motors=motors, motor_aliases=motors, joint_from_motor=both)
    motion = motion_of(log.changed(signals=kept), subject)
    assert motion.asked.all()
    hip, knee = motion.command
    assert hip == pytest.approx(12, rel=0.1)
    assert knee < 0.5


def test_without_reversals_no_friction_and_no_backlash():
    time = np.arange(2000) * 0.005
    signals = {"position/knee": 0.2 * time, "position_target/knee": 0.2 * time + 0.1}
    found = of(Log("ramp", time, signals, Metadata(gains={"knee": (20.0, 1.0)})))
    for effect in (
        "coulomb_friction",
        "viscous_friction",
        "stribeck_friction",
        "backlash",
        "load_dependent_friction",
    ):
        assert not found[effect].shown, effect
    assert "reverses" in found["coulomb_friction"].why
    assert found["payload"].shown


def test_without_any_torque():
    log = rig_log(gains={})
    log = spoiled(
        log,
        **{
            f"{kind}__{j}": None
            for kind in ("motor_torque_command", "motor_torque", "motor_current")
            for j in ("hip", "knee")
        },
    )
    found = of(log)
    assert not any(e.shown for e in found.values())
    assert "no torque" in found["coulomb_friction"].why
    assert "not told from controller_gain" in found["torque_constant"].why


def test_fast_content_tells_elasticity_from_delay():
    time = np.arange(4000) * 0.002
    position = 0.1 * np.sin(2 * np.pi * 15 * time)
    signals = {"position/knee": position, "position_target/knee": np.roll(position, 3)}
    found = of(Log("fast", time, signals, Metadata(gains={"knee": (20.0, 1.0)})))
    assert found["transmission_elasticity"].shown
    assert found["actuator_bandwidth"].shown
    assert not found["payload"].shown


def test_a_voltage_that_all_drives_follow_is_no_news():
    sagging = 12.0 - 2 * np.linspace(0, 1, 4000)
    line = (12.0, 3.0, 8.0)

    def shown(**supply):
        return of(spoiled(rig_log(supply=supply), battery_voltage=sagging))["voltage_sag"].shown

    assert shown()
    assert shown(hip=line)
    assert not shown(hip=line, knee=line)


def test_temperature_voltage_and_ground():
    ramp = np.linspace(0, 1, 4000)
    log = spoiled(
        rig_log(),
        motor_temperature__hip=30 + 40 * ramp,
        motor_temperature__knee=30 + ramp,
        battery_voltage=24 - 2 * ramp,
        contact_force__foot_z=ramp,
        gyro__x=ramp,
    )
    found = of(log)
    assert found["thermal_derating"].where == ("hip",)
    assert found["voltage_sag"].shown
    assert found["ground_compliance"].where == ("foot",)
    assert not found["ground_friction"].shown
    assert found["imu_bias"].where == ("gyro",)


def test_metres_of_a_slide_count_over_a_lever():
    log, sliding = rig_log(), robot()
    sliding.tree.hinge = np.array([False, True])
    turns, slides = motion_of(log, robot()), motion_of(log, sliding)
    for name in ("swing", "acceleration"):
        ratio = getattr(slides, name) / getattr(turns, name)
        np.testing.assert_allclose(ratio, [1 / RULES.motion.lever, 1.0])
    np.testing.assert_array_equal(turns.posture, [True, True])
    np.testing.assert_array_equal(slides.posture, [False, True])
    np.testing.assert_array_equal(slides.turning, [False, True])


def test_the_zero_of_a_slide_that_nothing_turns_does_not_show():
    sliding = robot(gains=np.ones((2, 2)))
    sliding.tree.hinge = np.array([False, True])
    found = {e.effect: e for e in excitation_of(rig_log(), sliding)}
    for effect in ("encoder_offset", "link_com"):
        assert found[effect].where == ("knee",)
    assert found["joint_spring"].where == ("hip", "knee")


def test_the_acceleration_of_a_slow_swing_is_that_of_its_sine():
    time = np.arange(4000) * 0.005
    log = Log("run", time, {"position/hip": 0.5 * np.sin(3 * time)}, Metadata())
    acceleration = motion_of(log, None).acceleration
    # exceeded for a twentieth of the time by a sine: cos(pi / 40) of its amplitude
    np.testing.assert_allclose(acceleration, 0.5 * 3**2 * np.cos(np.pi / 40), rtol=0.01)
    without = {"motor_torque/hip": np.cos(3 * time)}
    found = {e.effect: e for e in excitation_of(log.changed(signals=log.signals | without))}
    assert found["rotor_inertia"].shown
    assert not found["controller_gain"].shown


@pytest.mark.parametrize(
    ("effect", "asked", "where"),
    [
        ("backlash", True, ("b",)),
        ("coulomb_friction", True, ("a", "b")),
        ("coulomb_friction", False, ("b",)),
        ("payload", False, ("a", "b")),
    ],
)
def test_torque_sensors_behind_gears_hide_what_acts_before_them(effect, asked, where):
    log = SimpleNamespace(
        metadata=Metadata(torque_sensors=("a", "elsewhere")),
        has=lambda kind, name: kind == "joint_torque" and name == "a",
    )
    one = EFFECTS[effect]
    facts = SimpleNamespace(joints=np.array(["a", "b"]), asked=np.array([asked, True]))
    found = beside_sensors(
        Excitation(effect, True, ("a", "b"), "moves"), EFFECTS[effect], log, facts
    )
    assert (found.shown, found.where, found.why) == (True, where, "moves")
    alone = beside_sensors(Excitation(effect, True, ("a",), "moves"), one, log, facts)
    assert alone.shown == ("a" in where)
    assert alone.why == "moves" if alone.shown else "torque sensors behind the gears" in alone.why
