import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.ablation import ablate
from hyperleg_design.robot.design import Design, load_design
from hyperleg_design.robot.masses import mass_table
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.robot.motors import catalogue
from hyperleg_design.robot.names import JOINTS, VARIANTS
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.sizing.analysis import analyze
from hyperleg_design.sizing.envelope import MotorEnvelope, torque_limits
from hyperleg_design.sizing.zonotope import support
from hyperleg_design.sweep.measuring import measure, measures
from hyperleg_design.sweep.measuring.batch import Batch

BASE = load_design("hyperleg")
N = 24


def batch(seed=0, count=N):
    rng = np.random.default_rng(seed)
    return BASE.with_values(
        {
            "toe.mass": rng.uniform(0.1, 0.5, count),
            "toe.com": BASE.toe.com * rng.uniform(0.8, 1.2, (count, 1)),
            "thigh.length": rng.uniform(0.33, 0.42, count),
            "actuators.knee.gear": rng.uniform(5, 12, count),
            "actuators.ankle.motor": rng.choice(["RI50", "RI60", "RI70"], count),
            "transmission.scale.ankle_pitch": rng.uniform(0.6, 1.6, count),
        }
    )


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_batch_equals_its_designs_one_by_one(variant):
    designs = ablate(batch(), variant)
    together = measures.evaluate(designs)
    for i in range(N):
        alone = measures.evaluate(designs.take(i))
        assert list(alone) == list(together)
        for column, values in together.items():
            np.testing.assert_allclose(values[i], alone[column][0], rtol=1e-12, err_msg=column)


SIMULATED = ("joints.", "contact.", "transmission.linkage.")
"""Sections that no sizing measure reads."""
LEAVES = sorted(
    p
    for p, rule in parameters.rules(Design).items()
    if rule.kind == "number" and not p.startswith(SIMULATED)
)


@pytest.mark.parametrize("variant", ["toe", pytest.param("toe_removed", marks=pytest.mark.slow)])
def test_a_batch_in_any_one_leaf_equals_its_designs(variant):
    """Whichever leaf it is, the others staying single numbers."""
    made = 0
    for path in LEAVES:
        start = np.asarray(BASE[path], float)
        values = np.stack([start, start * 1.01 if np.any(start) else start])
        try:
            designs = ablate(BASE.with_values({path: values}), variant)
        except InputError:  # a leaf at its bound
            continue
        if not designs.batch_shape:  # the variant sets this leaf itself
            continue
        made += 1
        together = measures.evaluate(designs)
        alone = [measures.evaluate(designs.take(i)) for i in range(2)]
        for column, found in together.items():
            np.testing.assert_allclose(
                found, [a[column][0] for a in alone], rtol=1e-12, err_msg=f"{path}: {column}"
            )
    assert made > 0.8 * len(LEAVES)


def test_every_measure_has_its_columns_unit_and_meaning():
    found = measures.evaluate(BASE)
    assert tuple(found) == measures.columns(measures.measures_of(BASE))
    for column, values in found.items():
        entry = measures.measure_of(column)
        assert column in entry.columns
        assert entry.doc.endswith(".")
        assert values.shape == (1,)
        assert np.isfinite(values).all()


def test_only_the_toes_parts_are_missing_without_a_toe():
    for variant in VARIANTS[1:]:
        missing = {
            c for c, v in measures.evaluate(ablate(BASE, variant)).items() if np.isnan(v).any()
        }
        own = measures.columns(measures.measures_of(BASE))
        assert missing == {c for c in own if c.endswith(".toe")} - {"segment_mass.toe"}


def test_the_papers_robot():
    found = {k: float(v[0]) for k, v in measures.evaluate(BASE).items()}
    assert found["total_mass"] == pytest.approx(32.0, rel=1e-12)
    assert found["leg_mass"] == pytest.approx(8.27, rel=1e-12)
    # Table I
    for joint, printed in zip(
        JOINTS, (126.0, 126.0, 126.0, 211.95, 111.70, 48.44, 46.84), strict=True
    ):
        assert found[f"max_joint_torque.{joint}"] == pytest.approx(printed, rel=1e-3)
    assert found["zonotope_to_box_volume"] == pytest.approx(0.130, abs=5e-4)
    assert found["torque_alone.knee"] == pytest.approx(83.4, abs=0.05)


def test_leg_inertia_is_that_of_pinocchio():
    """The pitch-pitch entry of the mass matrix of a fixed base, straight, without rotors."""
    for variant in VARIANTS:
        design = ablate(batch(3, 2), variant).take(1)
        model = rigid_body_model(design, floating=False)
        matrix = model.mass_matrix(model.neutral()) - model.reflected
        assert measures.evaluate(design, ["swing_inertia"])["swing_inertia"][0] == pytest.approx(
            matrix[2, 2], rel=1e-10
        )


def test_actuators_weigh_what_a_change_of_motor_changes():
    heavy = BASE.with_values({"actuators.knee.motor": "RI80", "gears.law": "declared"})
    columns = [measures.evaluate(d, ["actuator_mass", "leg_mass"]) for d in (BASE, heavy)]
    gained = [float(columns[1][c][0] - columns[0][c][0]) for c in ("actuator_mass", "leg_mass")]
    assert gained[0] == pytest.approx(gained[1], rel=1e-9)
    assert gained[0] > 0
    without = ablate(BASE, "toe_removed")
    lost = (
        columns[0]["actuator_mass"][0]
        - measures.evaluate(without, ["actuator_mass"])["actuator_mass"][0]
    )
    assert lost == pytest.approx(
        float(mass_table(BASE).thigh - mass_table(without).thigh), rel=1e-9
    )


def test_holding_heat_is_least_among_all_motor_torques():
    """In the locked toe's leg one motor is spare; no other split of the torque is cooler."""
    design = ablate(BASE, "toe_locked")
    one = Batch(design)
    spare = np.linalg.svd(one.walking)[2][-1]
    tau = transmission.motor_torque(one.walking, one.push_off.torque, one.envelope.power_constant)
    heat = float(measures.evaluate(design, ["push_off_heat"])["push_off_heat"][0])
    for step in np.linspace(-2, 2, 41):
        assert np.sum(one.envelope.power_constant * (tau + step * spare) ** 2) >= heat * (1 - 1e-12)
    np.testing.assert_allclose(one.walking @ tau, one.push_off.torque, atol=1e-9)


@given(seed=st.integers(0, 2**31), motors=st.integers(1, 7))
@settings(max_examples=60, deadline=None)
def test_largest_power_is_the_maximum_over_the_rates(seed, motors):
    """Against a fine search over the rate, with the envelope's own limits."""
    rng = np.random.default_rng(seed)
    peak = rng.uniform(0.2, 5, motors)
    envelope = MotorEnvelope(
        rng.uniform(50, 400, motors),
        peak * rng.uniform(0.7, 15, motors),
        peak,
        np.ones(motors),
        0.9,
        0.8,
    )
    speed = rng.uniform(0, 60, motors) * (rng.random(motors) > 0.3)
    found = float(measures.largest_power(envelope, speed))
    if not speed.any():
        assert found == 0
        return
    turning = speed > 0
    limit = np.min(envelope.top_speed[turning] / speed[turning])
    corners = envelope.corner_speed[turning] / speed[turning]
    rate = np.concatenate([np.linspace(0, limit, 20001), corners[corners < limit]])[:, None]
    power = np.sum(rate * speed * torque_limits(envelope, rate * speed)[1], -1)
    assert found >= power.max() * (1 - 1e-12)
    assert found <= power.max() * (1 + 1e-6) + 1e-9


def test_push_off_power_is_a_support_of_the_speed_dependent_set():
    one = Batch(BASE)
    direction = np.array([0, 0, 0, -1.0, 1.0, 0, 0])
    best = 0.0
    for rate in np.linspace(0, 8, 4001):
        lower, upper = torque_limits(
            one.envelope, transmission.motor_velocity(one.walking, rate * direction)
        )
        best = max(best, float(support(one.walking, lower, upper, rate * direction)))
    assert measures.evaluate(BASE, ["push_off_power"])["push_off_power"][0] == pytest.approx(
        best, rel=1e-6
    )


def test_all_catalogue_motors_give_finite_measures():
    names = np.array(sorted(catalogue()))
    found = measures.evaluate(BASE.with_values({"actuators.knee.motor": names}))
    assert all(np.isfinite(v).all() for v in found.values())


def test_a_measure_needs_a_name_of_its_own_and_a_direction():
    def total_mass(one):
        """Twice."""
        return one

    with pytest.raises(ValueError, match="total_mass"):
        measure.measure("kg", "low")(total_mass)

    def another(one):
        """Undirected."""
        return one

    with pytest.raises(ValueError, match="another"):
        measure.measure("kg", "best")(another)
    assert "another" not in measure.MEASURES


def test_at_low_voltage_measures_at_standstill_follow_the_stall_torque():
    low = load_design("hyperleg", overrides={"electrical.voltage_ratio": 0.25})
    found = analyze(low)
    less, least = (
        {name: float(values[0]) for name, values in measures.evaluate(design).items()}
        for design in (low, low.with_values({"electrical.voltage_ratio": 0.2}))
    )
    for joint, torque in found["torque_alone"].items():
        assert less[f"torque_alone.{joint}"] == pytest.approx(torque)
    assert less["zonotope_to_box_volume"] == pytest.approx(found["zonotope_to_box_volume"])
    # below the hip all stall torques, in proportion to the voltage, are below the peak torques
    assert least["push_off_use"] == pytest.approx(1.25 * less["push_off_use"])
    assert least["max_joint_torque.knee"] == pytest.approx(0.8 * less["max_joint_torque.knee"])
