import dataclasses

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.protocol import load_protocol
from hyperleg_design.sweep.space import sweep_from_mapping
from hyperleg_design.sweep.trials.stored import stored, stored_names
from hyperleg_design.sweep.trials.trial_plan import kind_of, plan

SWEEP = sweep_from_mapping(
    {
        "design": "hyperleg",
        "sampling": "grid",
        "measures": ["total_mass"],
        "axes": {"toe mass": {"paths": ["toe.mass"], "values": [0.2, 0.4]}},
    }
)


def test_policies_are_those_of_each_kind_and_variant():
    wanted = plan(SWEEP, ["walk", "t_test"], seeds=1)
    assert [kind_of(p) for p in wanted.protocols] == ["walk", "t_test"]
    assert set(wanted.policies) == {(k, v) for k in ("walk", "t_test") for v in SWEEP.variants}
    assert all(len(files) == 1 for files in wanted.policies.values())


def test_the_digest_follows_the_protocol_and_the_policies():
    digests = {
        plan(SWEEP, protocols, seeds=seeds).digest
        for protocols, seeds in ((["walk"], 1), (["walk"], 2), (["t_test"], 1))
    }
    assert len(digests) == 3
    assert plan(SWEEP, [load_protocol("walk")], seeds=1).digest in digests


def test_two_protocols_of_a_kind_and_a_protocol_that_is_not_there_are_refused():
    with pytest.raises(InputError, match="one of each kind"):
        plan(SWEEP, ["walk", load_protocol("walk")])
    with pytest.raises(InputError, match="wlak"):
        plan(SWEEP, ["wlak"])


def test_one_trial_cannot_both_choose_a_policy_and_be_reported():
    single = load_protocol("walk").changed(trials=1)
    with pytest.raises(InputError, match=r"trials = 1: expects at least 2 .*--seeds 1"):
        plan(SWEEP, [single], seeds=2)
    assert plan(SWEEP, [single], seeds=1).protocols == (single,)


def test_a_folder_without_policies_is_refused(tmp_path):
    with pytest.raises(InputError):
        plan(SWEEP, ["walk"], policies=[tmp_path])


def test_the_committed_trials_are_of_the_protocols_and_policies_of_today():
    for name in stored_names():
        committed = stored(name)
        assert plan(committed.sweep, committed.sweep.evaluated).digest == committed.plan


def test_a_floor_that_is_not_even_is_another_protocol():
    walk = load_protocol("walk")
    rough = dataclasses.replace(
        walk, randomisation=dataclasses.replace(walk.randomisation, uneven_floor=0.03)
    )
    assert plan(SWEEP, [rough], seeds=1).digest != plan(SWEEP, [walk], seeds=1).digest
