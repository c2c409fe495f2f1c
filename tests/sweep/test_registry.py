import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import measures as trial_measures
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing.analysis import analyze
from hyperleg_design.sweep import registry
from hyperleg_design.sweep.measuring import measure
from hyperleg_design.sweep.measuring import measures as sizing


def test_all_that_sweeps_compute_and_evaluate_measures_is_there_under_the_same_name():
    known = registry.entries()
    assert set(sizing.columns(measure.MEASURES)) <= set(known)
    for protocol, table in (("walk", trial_measures.WALK), ("t_test", trial_measures.T_TEST)):
        for name in table:
            entry = registry.resolve(f"{protocol}.{name}", [protocol])
            assert entry is registry.resolve(name, [protocol]) or name in known
            assert entry.name == f"{protocol}.{name}"
    for entry in known.values():
        assert entry.doc
        assert entry.better in ("low", "high", "")


def test_numbers_that_analyze_prints_have_a_measure():
    found = analyze(load_design("toe"))
    numbers = {k for k, v in found.items() if isinstance(v, float)}
    joints = {f"{k}.{j}" for k in ("max_joint_torque", "torque_alone") for j in ("knee", "toe")}
    assert (numbers | joints) - set(registry.entries()) == set()


@pytest.mark.parametrize(
    ("name", "protocols", "text"),
    [
        ("cost_of_transport", ["walk", "t_test"], "give walk.cost_of_transport or t_test"),
        ("cost_of_transport", [], "--evaluate"),
        ("t_test.time", ["walk"], "needs that t_test is evaluated"),
        ("cost_of_transprt", ["walk"], "no such measure"),
    ],
)
def test_a_name_that_is_not_clear_is_one_clear_error(name, protocols, text):
    with pytest.raises(InputError, match=text):
        registry.resolve(name, protocols)


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("mass", ["total_mass", "leg_mass"]),
        ("walk.cot", ["walk.cost_of_transport"]),
        ("cot", ["walk.cost_of_transport", "t_test.cost_of_transport"]),
        ("leg_mas", ["leg_mass"]),
        ("t_test.tme", ["t_test.time"]),
    ],
)
def test_an_unknown_measure_is_answered_with_those_that_it_may_stand_for(name, near):
    assert set(near) <= set(registry.nearest_measures(name))
    with pytest.raises(InputError, match=f"did you mean .*{near[0]}.*list measures shows all"):
        registry.resolve(name, ["walk", "t_test"])


def test_no_measure_of_another_protocol_or_of_no_likeness_is_proposed():
    assert registry.nearest_measures("walk.cot") == ["walk.cost_of_transport"]
    assert registry.nearest_measures("zzzzzzzz") == []


def test_labels_have_units():
    assert registry.label("walk.grf_peak") == "walk, grf peak [N]"
    assert registry.label("swing_inertia") == "swing inertia [kg m²]"
