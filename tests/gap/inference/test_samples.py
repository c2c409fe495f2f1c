import diagnosed
import pytest


@pytest.fixture(scope="module")
def ready(robot_files):
    return diagnosed.evidence(
        robot_files["coupled"],
        *(diagnosed.run("healthy", s, session="a" if s < 2 else "b") for s in range(3)),
    )


def test_folds_deal_stretches_of_all_logs(ready):
    samples = ready.samples
    assert samples.sessions == 2
    for fold in range(samples.folds):
        assert set(samples.log[samples.fold == fold]) == {0, 1, 2}
