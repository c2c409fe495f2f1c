import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.inference.samples import BLOCKS, LOGS, products


@pytest.fixture(scope="module")
def ready(robot_files):
    return diagnosed.prepared(
        robot_files["coupled"],
        *(diagnosed.run("healthy", s, session="a" if s < 2 else "b") for s in range(3)),
    )


def test_every_sample_is_in_one_piece_and_pieces_are_of_one_kind(ready):
    samples = ready.base.samples
    seen = np.zeros(len(samples.value), int)
    for piece in samples.pieces:
        part = slice(piece.start, piece.stop)
        seen[part] += 1
        assert set(samples.group[part]) == {piece.group}
        assert set(samples.part[part]) == {piece.part}
    assert np.all(seen == 1)


def test_folds_deal_stretches_of_all_logs_or_whole_logs(ready):
    samples = ready.base.samples
    assert samples.sessions == 2
    assert samples.folds(LOGS) == 3
    for fold in range(samples.folds(BLOCKS)):
        assert set(samples.log[samples.fold[BLOCKS] == fold]) == {0, 1, 2}
    for log in range(3):
        assert len(set(samples.fold[LOGS][samples.log == log])) == 1


def test_sums_of_products_are_those_of_all_samples(ready):
    base = ready.base
    rng = np.random.default_rng(0)
    columns = rng.normal(size=(2, len(base.value)))
    found = products(base.samples, columns, base.packed)
    assert np.allclose(found.own.sum((0, 1)), columns @ columns.T)
    assert np.allclose(found.cross.sum((0, 1)), columns @ base.stacked.T)
    assert np.allclose(sum(one.whole().sum(0) for one in base.total), base.stacked @ base.stacked.T)
