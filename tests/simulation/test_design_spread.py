from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.load import load_robot
from hyperleg_design.simulation.design_spread import design_spread, load_design_spread
from hyperleg_design.simulation.settings import Physics

DATA = {"pool": 6, "held_out": 3, "ranges": {"toe.mass": {"low": 0.05, "high": 1.0, "log": True}}}


def test_the_pool_is_the_same_every_time_and_held_out_designs_are_others() -> None:
    base, spread = load_design("toe"), design_spread(DATA, "file")
    pool, again = spread.designs(base), design_spread(DATA, "file").designs(base)
    np.testing.assert_array_equal(pool["toe.mass"], again["toe.mass"])
    kept_apart = spread.held_out_designs(base)["toe.mass"]
    assert pool.batch_shape == (6,)
    assert kept_apart.shape == (3,)
    assert not np.isin(kept_apart, pool["toe.mass"]).any()


@pytest.mark.parametrize(("design", "ranges"), [("toe", "toe"), ("toe_removed_matched", "no_toe")])
def test_shipped_designs_are_inside_their_ranges(design: str, ranges: str) -> None:
    base, spread = load_design(design), load_design_spread(ranges)
    assert spread.ranges.outside(base) == []
    assert spread.held_out >= 12
    drawn = spread.held_out_designs(base)
    assert np.abs(spread.ranges.numbers(drawn)).max() <= 1


@pytest.mark.parametrize(("design", "ranges"), [("toe", "no_toe"), ("toe_removed", "toe")])
def test_ranges_of_another_toe_layout_are_refused(design: str, ranges: str) -> None:
    base, spread = load_design(design), load_design_spread(ranges)
    for draw in (spread.designs, spread.held_out_designs):
        with pytest.raises(InputError, match=f"these toe layouts, not {design}"):
            draw(base)


def test_what_is_written_down_is_what_was_read() -> None:
    spread = design_spread({**DATA, "variants": ["toe"]}, "file")
    assert design_spread(spread.to_mapping(), "file") == spread


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"pol": 3}, "pol"),
        ({"pool": 0}, "pool"),
        ({"pool": 2.5}, "pool"),
        ({"pool": True}, "pool"),
        ({"seed": 1000}, "held_out_seed"),
        ({"ranges": {}}, ""),
        ({"variants": ["no_toe"]}, "variants"),
        ({"variants": "toe"}, "variants"),
        ({"ranges": {"toe.mass": {"low": 0}}}, "toe.mass"),
    ],
)
def test_bad_input_names_the_field(change: dict, field: str) -> None:
    with pytest.raises(InputError) as error:
        design_spread({**DATA, **change}, "file")
    assert error.value.field == field


def test_ranges_that_give_no_robots_are_refused() -> None:
    data = {**DATA, "ranges": {"thigh.length": {"low": -2.0, "high": -1.0}}}
    with pytest.raises(InputError, match="narrow the ranges"):
        design_spread(data, "file").designs(load_design("toe"))


def test_leaves_that_a_robot_lacks_or_that_change_nothing_are_named() -> None:
    ranges = {
        "toe.mass": {"low": 0.05, "high": 1.0},
        "joints.toe.stiffness": {"low": 4.0, "high": 60.0},
        "actuators.toe.derate": {"low": 0.6, "high": 1.0},
        "actuators.knee.derate": {"low": 0.6, "high": 1.0},
        "joints.knee.coulomb": {"low": 0.6, "high": 1.0},
    }
    spread = design_spread({**DATA, "ranges": ranges}, "file")
    spread.check_robot(load_design("toe"), Physics())
    for use in (spread.held_out_designs, lambda robot: spread.check_robot(robot, Physics())):
        with pytest.raises(InputError, match=r"toe\.mass: of mini_cheetah: no such field"):
            use(load_robot("mini_cheetah"))
    for variant in ("toe_locked", "toe_removed"):
        with pytest.raises(InputError, match=f"of {variant}; leave out joints.toe.stiffness, act"):
            spread.check_robot(load_design(variant), Physics())
