import numpy as np
import pytest
import robots
from diagnosed import conditioned

from hyperleg_design.errors import InputError
from hyperleg_design.gap.playback.measure import measure


@pytest.fixture(scope="module")
def stiction():
    """The coupled rig with more friction at the knee than its file says."""
    text = robots.COUPLED.replace(
        'name="knee" axis="0 1 0" damping="0.03"', 'name="knee" axis="0 1 0" damping="0.23"'
    )
    return robots.servo_run(text, robots.waves(2, [1.0, 1.0]), 10.0)


def test_a_faultless_log_has_no_excess_over_its_references(robot_files, runs):
    one, two = conditioned(
        robot_files["coupled"], robots.noisy(runs["coupled"], 0), robots.noisy(runs["coupled"], 1)
    )
    gap = measure([one], [two])
    assert gap.floor_from == "reference"
    for row in gap.select("torque"):
        assert row.gap == pytest.approx(row.floor, rel=0.2)


def test_the_gap_lies_where_the_fault_is(robot_files, runs, stiction):
    test, reference = conditioned(
        robot_files["coupled"], robots.noisy(stiction, 0), robots.noisy(runs["coupled"], 1)
    )
    gap = measure([test], [reference])
    rows = {r.location: r for r in gap.select("torque", "joint")}
    assert rows["knee"].share > 0.9
    truth = 0.2 * np.sqrt(np.mean(test.velocity[test.valid, 1] ** 2))
    assert rows["knee"].excess == pytest.approx(truth, rel=0.1)
    # both motors drive the knee, with four and minus four: the fault shows at both alike
    motors = {r.location: r for r in gap.select("torque", "motor")}
    assert motors["m_front"].excess == pytest.approx(motors["m_back"].excess, rel=0.2)
    assert motors["m_front"].excess == pytest.approx(truth / 8, rel=0.2)
    # the logged torque exceeds the needed one in the direction of motion, more the faster it is
    regimes = {r.regime: r for r in gap.select("torque", "joint", "knee", "")}
    assert regimes["forward"].mean > 0.1
    assert regimes["backward"].mean < -0.1
    assert regimes["fast"].gap > 1.5 * regimes["slow"].gap
    assert regimes["still"].gap < 0.3 * regimes["fast"].gap
    position = {r.location: r for r in gap.select("position", "joint")}
    assert position["knee"].gap > 3 * position["knee"].floor


def test_shares_of_all_places_add_up(robot_files, runs, stiction):
    (test,) = conditioned(robot_files["coupled"], robots.noisy(stiction, 0))
    gap = measure([test])
    assert gap.floor_from == "split"
    for signal, kind in (("torque", "joint"), ("torque", "motor"), ("position", "joint")):
        assert sum(r.share for r in gap.select(signal, kind)) == pytest.approx(1.0)


def test_table_and_bands(robot_files, runs, stiction):
    (test,) = conditioned(robot_files["coupled"], robots.noisy(stiction, 0))
    gap = measure([test], predict=False)
    table = gap.table()
    assert len({len(column) for column in table.values()}) == 1
    bands = [r for r in gap.select("torque", "joint", "knee", "") if r.regime.endswith("Hz")]
    whole = gap.select("torque", "joint", "knee")[0]
    assert np.sqrt(sum(r.gap**2 for r in bands if r.regime != "10-25 Hz")) == pytest.approx(
        whole.gap, rel=0.05
    )


def test_no_logs():
    with pytest.raises(InputError, match="at least one log"):
        measure([])


@pytest.mark.filterwarnings("error")
def test_motors_whose_torque_nobody_logs_are_left_out(robot_files, runs):
    whole = runs["arm"]
    dropped = {
        column: values
        for column, values in whole.signals.items()
        if not column.startswith("position_target/")
        and not (column.startswith("motor_torque") and column.endswith("/a3"))
    }
    (log,) = conditioned(robot_files["arm"], whole.changed(signals=dropped))
    places = {row.location for row in measure([log]).select("torque")}
    assert "elbow" not in places
    assert len(places) == 5
