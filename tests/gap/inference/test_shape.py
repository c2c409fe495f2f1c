import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.inference.fit import Design
from hyperleg_design.gap.inference.held_out import predict
from hyperleg_design.gap.inference.shape import KINDS, OF_ENCODER, columns, shapes


@pytest.fixture(scope="module")
def ready(robot_files):
    return diagnosed.prepared(
        robot_files["coupled"], *(diagnosed.run("cubic", s, session="a") for s in (0, 1))
    )


def of_hip(base):
    """Held-out likelihood of each shape at the hip, by name."""
    nothing = Design(base).fit()
    row = next(i for i, r in enumerate(base.samples.rows) if r.name == "hip")
    found = {one.name: columns(base, nothing, one) for one in shapes(base.samples, np.array([row]))}
    return {
        name: predict(Design(base, ridge=own)).total
        for name, own in found.items()
        if own is not None
    }


def test_a_shape_of_position_tells_a_hardening_spring(ready):
    base = ready.base
    gains = of_hip(base)
    nothing_held = predict(Design(base)).total
    assert gains["position"] > nothing_held + 10
    assert max(gains, key=gains.__getitem__) in (
        "position",
        "load_over_position",
        "encoder_over_position",
    )
    assert gains["rhythm"] < nothing_held + 5
    assert set(gains) <= set(KINDS)


def test_friction_that_fades_away_is_told_from_friction_that_stays(robot_files):
    logs = []
    for seed in (0, 1):
        log = diagnosed.run("healthy", seed, session="a")
        fading = (
            0.2 * np.exp(-(log.time - log.time[0]) / 4) * np.tanh(log.column("velocity/hip") / 0.02)
        )
        logs.append(
            log.changed(
                signals={
                    c: v + fading if c.startswith("motor_torque/") else v
                    for c, v in log.signals.items()
                }
            )
        )
    base = diagnosed.prepared(robot_files["coupled"], *logs).base
    gains = of_hip(base)
    best, second = sorted(gains, key=gains.__getitem__)[:-3:-1]
    assert best == "friction_over_time"
    assert gains[best] > gains[second] + 10


def test_columns_are_finite_and_sit_in_their_row(ready):
    base = ready.base
    nothing = Design(base).fit()
    for one in shapes(base.samples, np.arange(len(base.samples.rows))):
        found = columns(base, nothing, one)
        if found is None:
            continue
        assert np.isfinite(found).all()
        if one.row >= 0 and one.name not in OF_ENCODER:
            assert not found[:, base.samples.row != one.row].any()
