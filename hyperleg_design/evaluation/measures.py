"""What is measured on trials: each measure's unit, meaning, and whether less or more is better."""

from __future__ import annotations

from dataclasses import dataclass

from hyperleg_design.evaluation.motion.power import GROUPS

LESS, MORE, NEITHER = "less", "more", ""


@dataclass(frozen=True)
class Measure:
    """One number of a trial."""

    name: str
    unit: str
    meaning: str
    better: str = NEITHER
    """`LESS`, `MORE` or `NEITHER`."""


def _table(*rows: Measure) -> dict[str, Measure]:
    return {row.name: row for row in rows}


OUTCOMES = _table(
    Measure("arrived", "", "1 where the goal was reached", MORE),
    Measure("fell", "", "1 where the robot fell", LESS),
    Measure("lost", "", "1 where it left the course", LESS),
    Measure("timed_out", "", "1 where the time limit came first", LESS),
    Measure("diverged", "", "1 where the simulation left what can be computed", LESS),
)
"""How a trial ended; of every protocol."""

POWER = _table(
    Measure(
        "power",
        "W",
        "Joule heat plus signed mechanical power of all motors, the paper's total",
        LESS,
    ),
    Measure("joule_power", "W", "Joule heat of all motors", LESS),
    Measure("mechanical_power", "W", "signed mechanical power of all motors", LESS),
    Measure("positive_power", "W", "mechanical power of driving motors", LESS),
    Measure("negative_power", "W", "mechanical power of braking motors, not positive"),
    Measure(
        "battery_power",
        "W",
        "drawn from the battery less returned, driver efficiencies included",
        LESS,
    ),
    Measure("energy", "J", "integral of power", LESS),
    Measure("cost_of_transport", "", "energy / (m g distance)", LESS),
)
"""Measures of power and energy over the whole trial, which every protocol has."""

IMPACT = _table(
    Measure(
        "grf_peak",
        "N",
        "largest filtered vertical force on the foot within the window after touchdown, mean over "
        "touchdowns",
        LESS,
    ),
    Measure("grf_peak_body_weights", "", "the same in body weights", LESS),
    Measure("grf_raw_peak", "N", "the same without filter", LESS),
    Measure("grf_loading_rate", "N/s", "mean slope from 20 to 80 % of that peak", LESS),
    Measure("grf_impulse", "Ns", "integral of the filtered force over the window", LESS),
)
"""Measures of impacts, which every protocol has."""

STEPS = _table(
    Measure("cadence", "1/s", "steps over time, both feet"),
    Measure("step_length", "m", "from touchdown to touchdown of the other foot, along the way"),
    Measure("duty_factor", "", "contact over stride; also when toe-off comes"),
    Measure("double_support", "", "share of time with both feet on the floor"),
    Measure("flight", "", "share of time with none"),
    Measure("slip_per_step", "m", "way that a foot slides in a contact, to and fro, mean", LESS),
    Measure(
        "foot_drift",
        "m",
        "how far a foot has moved between first and last standing flat in a contact, straight, "
        "mean",
        LESS,
    ),
    Measure("largest_slip", "m", "the same, largest", LESS),
)
"""Measures of steps, which every protocol has."""

BEARING = _table(
    Measure("largest_tilt", "rad", "largest lean of the pelvis over the whole trial", LESS),
    Measure("stop_share", "", "share of time on a stop of the joint that is there most", LESS),
    Measure("stop_overshoot", "rad", "farthest that a joint goes past its stop", LESS),
    Measure("stop_absorbed_power", "W", "taken from the joints by their stops", LESS),
    Measure(
        "stop_returned_power",
        "W",
        "given back to the joints by the springs of their stops, which no motor pays; the rest of "
        "what they absorb is lost",
        LESS,
    ),
    Measure("vibration", "rad/s", "RMS velocity above 15 Hz of the joint that has most", LESS),
    Measure(
        "limit_share",
        "",
        "share of time on the edge of its envelope of the motor that is there most",
        LESS,
    ),
    Measure("continuous_use", "", "RMS over rated torque of the motor with most", LESS),
    Measure(
        "thermal_peak",
        "",
        "largest moving average over 3 s of squared torque over rated torque, of the motor with "
        "most",
        LESS,
    ),
)
"""Measures of posture and stops, which every protocol has."""

_KINDS = {
    "": "signed",
    "_positive": "of joints that are driven",
    "_absolute": "driving and braking both counted as positive, joint by joint",
}
RIGHT_LEG = _table(
    *(
        Measure(
            f"right_{group}{kind}_power", "W", f"mechanical power of the right {group}, {words}"
        )
        for group in GROUPS
        for kind, words in _KINDS.items()
    ),
    Measure("right_joule_power", "W", "Joule heat of the right leg's motors", LESS),
    Measure(
        "right_total_power", "W", "Joule heat and signed mechanical power of the right leg", LESS
    ),
)
"""Means over the right leg's steady strides (Fig. 6); of the walk protocol."""

WALK = {
    **OUTCOMES,
    **POWER,
    **_table(
        Measure("time", "s", "from the start to the distance, of those that arrived", LESS),
        Measure("distance", "m", "from the start at the end, straight"),
        Measure("path", "m", "way of the pelvis"),
        Measure("mean_speed", "m/s", "distance over time, of those that arrived"),
        Measure("sideways", "m", "to the left of the heading at the start, at the end"),
        Measure("turned", "rad", "heading at the end less that at the start"),
        Measure("driver_loss", "W", "heat of the drivers", LESS),
        Measure("battery_energy", "J", "integral of battery power", LESS),
        Measure("battery_cost_of_transport", "", "battery energy / (m g distance)", LESS),
        Measure("steady_speed", "m/s", "mean speed over the steady strides"),
        Measure("steady_power", "W", "power over the steady strides", LESS),
        Measure("steady_joule_power", "W", "Joule heat over the steady strides", LESS),
        Measure(
            "steady_mechanical_power", "W", "signed mechanical power over the steady strides", LESS
        ),
        Measure(
            "steady_positive_power", "W", "power of driving motors over the steady strides", LESS
        ),
        Measure("steady_negative_power", "W", "power of braking motors over the steady strides"),
        Measure("steady_battery_power", "W", "battery power over the steady strides", LESS),
        Measure(
            "steady_cost_of_transport", "", "energy / (m g distance) over the steady strides", LESS
        ),
        Measure(
            "steady_battery_cost_of_transport",
            "",
            "battery energy / (m g distance) over the steady strides",
            LESS,
        ),
        Measure("step_width", "m", "between touchdowns of both feet, across the way"),
        Measure("heel_off", "", "when the heel leaves the floor, share of the stride"),
        Measure("single_support", "", "share of time with one foot on the floor"),
        Measure(
            "alternation", "", "share of steps made by the other foot than the one before", MORE
        ),
        Measure("heel_lead", "s", "load on the heel before the forefoot at touchdown"),
        Measure("heel_or_flat", "", "share of steps that touch down heel first or flat", MORE),
        Measure("knee_touchdown", "rad", "knee flexion at touchdown"),
        Measure("knee_midstance", "rad", "knee flexion in the middle of a contact, mean"),
        Measure("knee_swing", "rad", "largest knee flexion of a swing"),
        Measure("ankle_dorsiflexion", "rad", "largest ankle dorsiflexion of a contact"),
        Measure(
            "event_order",
            "",
            "share of contacts with heel strike, foot flat, heel off and toe off in that order",
            MORE,
        ),
        Measure("force_humps", "", "humps of the mean contact's vertical force, low-passed"),
        Measure("push_off_force", "", "the last of two humps or more, in body weights"),
        Measure(
            "ankle_push_off_power",
            "W",
            "given by the motors to the ankle pitch joint in the last 30 % of a contact, mean",
        ),
        Measure("mean_tilt", "rad", "mean lean of the pelvis over the steady strides", LESS),
    ),
    **RIGHT_LEG,
    **IMPACT,
    **STEPS,
    **BEARING,
}
"""Measures of the walk protocol; impacts, steps and posture over the steady strides, except for
`largest_tilt`."""

T_TEST = {
    **OUTCOMES,
    **POWER,
    **_table(
        Measure("time", "s", "from the start to the last waypoint, of those that arrived", LESS),
        Measure("waypoints_reached", "", "in order", MORE),
        Measure("distance", "m", "way of the pelvis"),
        Measure("mean_speed", "m/s", "way over time, of those that arrived", MORE),
        Measure("peak_speed", "m/s", "largest horizontal speed of the pelvis, unfiltered", MORE),
        Measure(
            "mean_deviation", "m", "from the nearest point of the course, mean over time", LESS
        ),
        Measure("peak_deviation", "m", "from the nearest point of the course, largest", LESS),
        Measure("mean_leg_deviation", "m", "from the leg being run, mean over time", LESS),
        Measure("peak_leg_deviation", "m", "from the leg being run, largest", LESS),
        Measure("turned", "rad", "heading at the end less that at the start, whole turns counted"),
    ),
    **IMPACT,
    **STEPS,
    **BEARING,
}
"""Measures of the T-test protocol, over the whole run; besides them `waypoint_1`, `waypoint_2` and
so on, the times of arrival [s]."""

SHARES = frozenset(OUTCOMES) | {
    "alternation",
    "double_support",
    "duty_factor",
    "event_order",
    "flight",
    "heel_off",
    "heel_or_flat",
    "limit_share",
    "single_support",
    "stop_share",
}
"""Measures that lie in 0 .. 1: of trials, time, steps, contacts or strides."""


def measure_of(name: str) -> Measure:
    """Look up a measure of either protocol.

    Args:
        name: of the measure; `waypoint_1` and so on are times of arrival.

    Returns:
        The measure with unit, meaning and direction.

    Raises:
        KeyError: no such measure.
    """
    if name.startswith("waypoint_"):
        return Measure(
            name, "s", f"time of arrival at waypoint {name.removeprefix('waypoint_')}", LESS
        )
    return WALK[name] if name in WALK else T_TEST[name]
