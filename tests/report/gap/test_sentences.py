from __future__ import annotations

from hyperleg_design.report.gap.run import Run
from hyperleg_design.report.gap.sentences import (
    cause_row,
    joined,
    next_steps,
    phrase,
    probability_text,
    share_text,
    verdict_sentence,
)


def cause(effect: str, location: str, **parameters: tuple[float, str]) -> dict:
    values = {
        name: {"value": v, "low": 0.9 * v, "high": 1.1 * v, "unit": unit}
        for name, (v, unit) in parameters.items()
    }
    return {
        "effect": effect,
        "location": location,
        "probability": 0.9,
        "closed": 0.5,
        "parameters": values,
    }


def diagnosis(verdict: str, causes: list[dict], **changes: object) -> dict:
    plain = {"verdict": verdict, "causes": causes, "equivalent": [], "where": []}
    return plain | {"separating_experiment": None} | changes


FRICTION = [cause("coulomb_friction", place, torque=(0.2, "Nm")) for place in "abcd"]


def test_one_effect_at_several_places_is_said_once() -> None:
    assert phrase(FRICTION[:1]) == "Coulomb friction at a (torque 0.2 Nm)"
    assert phrase(FRICTION[:3]) == "Coulomb friction at a, b and c (torque 0.2 Nm)"
    many = [cause("coulomb_friction", f"j{i}", torque=(0.1 * i, "Nm")) for i in range(1, 7)]
    assert phrase(many) == "Coulomb friction at 6 joints (torque 0.1 to 0.6 Nm)"
    mixed = [*FRICTION[:2], cause("coulomb_friction", "slide", torque=(3.0, "N"))]
    assert phrase(mixed) == "Coulomb friction at a, b and slide"
    both = [FRICTION[0], cause("rotor_inertia", "b", inertia=(0.01, "kg m^2"))]
    assert phrase(both) == (
        "Coulomb friction at a (torque 0.2 Nm) and rotor inertia at b (inertia 0.01 kg m²)"
    )


def test_the_size_that_is_clearly_there_is_told() -> None:
    pulled = cause("joint_spring", "wrist", stiffness=(0.002, "Nm/rad"), preload=(-0.06, "Nm"))
    pulled["parameters"]["stiffness"] |= {"low": 0.0, "high": 0.02}
    pulled["parameters"]["preload"] |= {"low": -0.07, "high": -0.05}
    assert phrase([pulled]) == "joint spring at wrist (preload -0.06 Nm)"
    pulled["parameters"]["preload"] |= {"high": 0.01}
    assert phrase([pulled]) == "joint spring at wrist (stiffness 0.002 Nm/rad)"


def test_where_a_joint_rings_no_gap_beyond_the_noise_is_claimed() -> None:
    rings = [{"shape": "ringing", "location": name, "says": ""} for name in ("hip", "knee")]
    gap = {"before": 0.1, "floor": 0.1}
    ringing = diagnosis("unknown", [], residual_shape=rings, gap=gap)
    assert verdict_sentence(ringing).startswith("hip and knee ring or swing as in no reference")
    beyond = diagnosis("unknown", [], residual_shape=rings, gap=gap | {"before": 0.2})
    assert verdict_sentence(beyond).startswith("There is a gap")


def test_each_verdict_is_one_sentence() -> None:
    assert verdict_sentence(diagnosis("none", [])).endswith("no gap between robot and model.")
    lacking = diagnosis("none", [], lacks={"verdict": "explained", "causes": FRICTION})
    assert verdict_sentence(lacking) == "Nothing has changed since the reference logs."
    unknown = diagnosis("unknown", [], where=[{"location": "a", "regime": "all", "share": 1.0}])
    assert verdict_sentence(unknown).startswith("There is a gap at a, and no effect")
    assert verdict_sentence(diagnosis("explained", FRICTION[:2])) == (
        "Coulomb friction at a (torque 0.2 Nm) and b (torque 0.2 Nm) explain the gap."
    )
    everywhere = verdict_sentence(diagnosis("explained", FRICTION))
    assert everywhere == "Coulomb friction at a, b, c and d (torque 0.2 Nm) explains the gap."
    rest = diagnosis("explained", FRICTION, remainder=0.2)
    assert verdict_sentence(rest).endswith("(torque 0.2 Nm) explains most of the gap.")
    pair = [[{"effect": "payload", "location": "arm"}, {"effect": "imu_bias", "location": "gyro"}]]
    either = [cause("payload", "arm", mass=(1.0, "kg"))]
    assert verdict_sentence(diagnosis("ambiguous", either, equivalent=pair)) == (
        "Either payload at arm or IMU bias at gyro: these logs cannot tell which."
    )
    beside = diagnosis("ambiguous", [*FRICTION[:1], *either], equivalent=pair)
    assert verdict_sentence(beside) == (
        "Coulomb friction at a (torque 0.2 Nm), and either payload at arm or IMU bias at gyro: "
        "these logs cannot tell which."
    )


def test_parameters_are_rows_with_their_intervals() -> None:
    row = cause_row(cause("rotor_inertia", "b", inertia=(0.01, "kg m^2")))
    assert (row.effect, row.location, row.closed, row.probability) == (
        "Rotor inertia",
        "b",
        "50 %",
        "0.90",
    )
    assert [(v.name, v.value, v.interval) for v in row.values] == [
        ("inertia", "0.01 kg m²", "0.009 to 0.011")
    ]


def test_steps_go_with_the_verdict() -> None:
    assert [command.split()[2] for _, command in next_steps(diagnosis("explained", FRICTION))] == [
        "apply"
    ]
    assert [command.split()[2] for _, command in next_steps(diagnosis("unknown", []))] == [
        "diagnose",
        "excite",
    ]


def test_commands_hold_the_paths_of_the_run() -> None:
    run = Run("my arm.xml", ("a.parquet", "b.parquet"), "results/gap")
    ((_, command),) = next_steps(diagnosis("explained", FRICTION), run)
    assert command == (
        "hyperleg gap apply results/gap --robot 'my arm.xml' --logs OTHER_LOG "
        "--out results/gap_overlay.yaml"
    )
    commands = [command for _, command in next_steps(diagnosis("unknown", []), run)]
    assert commands == [
        "hyperleg gap diagnose --robot 'my arm.xml' --logs a.parquet b.parquet "
        "--reference HEALTHY_LOG --out results/gap_with_reference",
        "hyperleg gap excite --robot 'my arm.xml' --out motions",
    ]


def test_a_row_of_many_places_has_the_range_of_each_value() -> None:
    many = [cause("torque_constant", f"m{i}", scale=(0.1 * i, "")) for i in range(5, 10)]
    many[0]["closed"], many[1]["probability"] = 0.2, 0.7
    row = cause_row(*many)
    assert (row.location, row.closed, row.probability) == ("5 motors", "20 % to 50 % each", "0.70")
    assert [(v.name, v.value, v.interval) for v in row.values] == [
        ("scale", "0.5 to 0.9", "0.45 to 0.99")
    ]


def test_small_numbers_read_well() -> None:
    assert (share_text(0.001), share_text(0.456)) == ("–", "46 %")
    assert (probability_text(0.001), probability_text(0.5)) == ("< 0.01", "0.50")
    assert joined([]) == ""
    assert joined(["a"]) == "a"
    assert joined(["a", "b", "c"], "or") == "a, b or c"
