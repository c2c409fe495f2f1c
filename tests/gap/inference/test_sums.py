import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.inference.samples import products


@pytest.fixture(scope="module")
def base(robot_files):
    return diagnosed.prepared(
        robot_files["coupled"],
        *(diagnosed.run("healthy", s, session=name) for s, name in ((0, "a"), (1, "b"))),
    ).base


def dense(base, session):
    """Products by group, the plain way."""
    samples = base.samples
    found = np.zeros((samples.groups, len(base.stacked), len(base.stacked)))
    mine = samples.session[samples.part] == session
    for group in range(samples.groups):
        own = base.stacked[:, mine & (samples.group == group)]
        found[group] = own @ own.T
    return found


def test_what_is_left_out_is_nothing(base):
    for session in range(2):
        assert np.allclose(base.total[session].whole(), dense(base, session))
    assert sum(len(one) for one in base.layout.shown) < 0.9 * len(base.stacked) * len(
        base.samples.rows
    )


def test_weighed_sums_and_squares_are_those_of_the_whole(base):
    rng = np.random.default_rng(0)
    weight, combination = (
        rng.uniform(0.1, 2, base.samples.groups),
        rng.normal(size=len(base.stacked)),
    )
    whole = dense(base, 0)
    assert np.allclose(base.total[0].weighed(weight), np.tensordot(weight, whole, 1))
    assert np.allclose(
        base.total[0].square(combination), np.einsum("p,gpq,q->g", combination, whole, combination)
    )


def test_folds_add_up(base):
    rest = base.part(0, 1, 0, False)
    fold = base.part(0, 1, 0, True)
    assert np.allclose((rest + fold).whole(), base.total[0].whole())
    assert np.allclose((base.total[0] - fold).whole(), rest.whole())


def test_products_of_sessions_are_those_of_their_parts(base):
    columns = np.random.default_rng(1).normal(size=(3, len(base.value)))
    columns[:, base.samples.row == 0] = 0.0
    whole, parts = (products(base.samples, columns, base.packed, whole=w) for w in (True, False))
    for session in range(2):
        mine = base.samples.session == session
        assert np.allclose(whole.own[session], parts.own[mine].sum(0))
        assert np.allclose(whole.cross[session], parts.cross[mine].sum(0))
