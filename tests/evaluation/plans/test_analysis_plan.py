"""The shipped plan compares what the study asks about; plans that cannot be carried out are
refused.
"""

from __future__ import annotations

import copy

import numpy as np
import pandas as pd
import pytest
import yaml

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.plans.analysis_plan import counted, load_plan, plan_from_mapping


@pytest.fixture
def mapping():
    return yaml.safe_load((resources.content_folder("sim") / "analysis_plan.yaml").read_text())


def test_the_shipped_plan():
    plan = load_plan()
    assert [o.name for o in plan.primary] == [
        "walk.steady_cost_of_transport",
        "t_test.time",
        "t_test.mean_deviation",
    ]
    assert plan.designs[:2] == ("toe", "toe_removed_matched")
    assert set(plan.attribution) == {"toe_locked", "toe_removed"}
    assert plan.seeds["walk"] >= 8
    assert plan.seeds["t_test"] >= 5
    assert plan.plateau.share == 0.2
    assert not {o.name for o in plan.primary} & {o.name for o in plan.secondary}


@pytest.mark.parametrize(
    ("path", "value", "field"),
    [
        ((), {"primary": None}, "primary"),
        ((), {"alpha": 0.05}, "alpha"),
        (("primary", 0), {"measure": "cost"}, "primary.0.measure"),
        (("primary", 0), {"margin": 0.0}, "primary.0.margin"),
        (("primary", 1), {"trials": "all"}, "primary.1.trials"),
        (("primary", 0), {"protocol": "run"}, "primary.0.protocol"),
        (("secondary", 0), {"margin": 0.1}, "secondary.0.margin"),
        (("secondary", 0), {"measure": "steady_cost_of_transport"}, "secondary"),
        (("seeds",), {"walk": 1}, "seeds.walk"),
        (("seeds",), {"walk": 2.5}, "seeds.walk"),
        (("arms",), {"compared": "toe"}, "arms"),
        (("plateau",), {"share": 0.9}, "plateau.share"),
    ],
)
def test_bad_plans_are_refused(mapping, path, value, field):
    data = copy.deepcopy(mapping)
    place = data
    for key in path:
        place = place[key]
    place.update(value)
    with pytest.raises(InputError) as caught:
        plan_from_mapping(data, "plan.yaml")
    assert caught.value.field == field


@pytest.mark.parametrize("key", ["name", "arms", "attribution", "seeds", "primary", "secondary"])
def test_nothing_is_left_open(mapping, key):
    del mapping[key]
    with pytest.raises(InputError) as caught:
        plan_from_mapping(mapping, "plan.yaml")
    assert caught.value.field == key


def test_measures_of_whole_runs_count_over_arrivals():
    table = pd.DataFrame(
        {"outcome": ["arrived", "fell", "timed_out"], "power": [1.0, 9.0, 2.0], "cadence": 2.0}
    )
    assert counted(table, "cadence") is table
    np.testing.assert_array_equal(counted(table, "power")["power"], [1.0, np.nan, np.nan])
    assert table["power"].tolist() == [1.0, 9.0, 2.0]  # the table itself stays
