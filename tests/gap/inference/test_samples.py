import diagnosed
import pytest

from hyperleg_design.gap.inference.samples import BLOCKS, LOGS


@pytest.fixture(scope="module")
def ready(robot_files):
    return diagnosed.evidence(
        robot_files["coupled"],
        *(diagnosed.run("healthy", s, session="a" if s < 2 else "b") for s in range(3)),
    )


def test_folds_deal_stretches_of_all_logs_or_whole_logs(ready):
    samples = ready.samples
    assert samples.sessions == 2
    assert samples.folds(LOGS) == 3
    for fold in range(samples.folds(BLOCKS)):
        assert set(samples.log[samples.fold[BLOCKS] == fold]) == {0, 1, 2}
    for log in range(3):
        assert len(set(samples.fold[LOGS][samples.log == log])) == 1
