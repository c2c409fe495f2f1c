import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design.simulation.stepping.streams import RowStreams, of_rows


def streams(sizes):
    return RowStreams([np.random.default_rng(k) for k in range(len(sizes))], sizes)


@given(st.lists(st.integers(1, 5), min_size=1, max_size=4), st.data())
def test_each_block_draws_as_if_it_were_alone(sizes, data):
    ends = np.cumsum(sizes)
    rows = np.array(sorted(data.draw(st.sets(st.integers(0, int(ends[-1]) - 1)))), int)
    together, alone = streams(sizes), [np.random.default_rng(k) for k in range(len(sizes))]
    for _ in range(2):
        some = together.of(rows).uniform(-1.0, 2.0, (len(rows), 3))
        whole = together.integers(7, int(ends[-1]))
        for k, (end, size) in enumerate(zip(ends, sizes, strict=True)):
            own = (rows >= end - size) & (rows < end)
            np.testing.assert_array_equal(
                some[own], alone[k].uniform(-1.0, 2.0, (int(own.sum()), 3))
            )
            np.testing.assert_array_equal(whole[end - size : end], alone[k].integers(7, size=size))


def test_a_state_is_gone_on_from():
    one = streams([2, 3])
    state = one.state
    first = one.uniform(size=5)
    one.restore(state)
    np.testing.assert_array_equal(one.uniform(size=5), first)
    old = streams([4])
    old.restore(np.random.default_rng(9).bit_generator.state)
    np.testing.assert_array_equal(old.uniform(size=4), np.random.default_rng(9).uniform(size=4))


def test_a_plain_generator_serves_all_rows():
    rng = np.random.default_rng(0)
    assert of_rows(rng, np.arange(3)) is rng
    assert of_rows(streams([2, 2]), np.array([3])).sizes == [1]
