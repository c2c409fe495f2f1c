import pytest

from hyperleg_design.gap.model.subject import load_subject
from hyperleg_design.validation.blind.real import (
    RealCase,
    data_folder,
    judged,
    real_cases,
    score_real,
)

PAYLOAD = RealCase("x", "r", (), (), "payload", ("arm", "servo"), ("mass", 0.2))


def cause(effect, location, **values):
    parameters = {
        k: {"value": v, "low": v - 0.05, "high": v + 0.05, "unit": ""} for k, v in values.items()
    }
    return {
        "effect": effect,
        "location": location,
        "probability": 0.9,
        "closed": 0.9,
        "parameters": parameters,
    }


def test_right_and_wrong_answers():
    right = judged(
        PAYLOAD, {"verdict": "explained", "causes": [cause("payload", "servo", mass=0.22)]}, 1.0
    )
    assert right.right
    assert right.inside
    assert right.probability == 0.9
    assert not judged(
        PAYLOAD, {"verdict": "explained", "causes": [cause("torque_constant", "servo")]}, 1.0
    ).right
    assert not judged(PAYLOAD, {"verdict": "none", "causes": []}, 1.0).right
    assert (
        judged(
            PAYLOAD, {"verdict": "explained", "causes": [cause("payload", "arm", mass=0.4)]}, 1.0
        ).inside
        is False
    )


def test_healthy_logs_must_stay_quiet():
    healthy = RealCase("x", "r", (), (), "")
    assert judged(healthy, {"verdict": "none"}, 1.0).right
    assert not judged(healthy, {"verdict": "unknown"}, 1.0).right


def test_soft_gains_are_no_delay():
    go2 = RealCase("x", "r", (), (), "-")
    assert not judged(
        go2, {"verdict": "explained", "causes": [cause("command_delay", "robot", delay=0.09)]}, 1.0
    ).right
    assert judged(
        go2, {"verdict": "explained", "causes": [cause("command_delay", "robot", delay=0.005)]}, 1.0
    ).right
    assert judged(go2, {"verdict": "unknown"}, 1.0).right


def test_absent_data_are_skipped_with_a_reason(tmp_path):
    found = score_real(tmp_path / "nowhere", diagnose=lambda *a, **k: {})
    assert found.rows == ()
    assert len(found.skipped) == 3
    assert "absent" in found.markdown()


@pytest.mark.skipif(not data_folder().is_dir(), reason="the real logs are not on this machine")
def test_cases_of_the_real_logs(tmp_path):
    cases, skipped = real_cases(data_folder(), tmp_path)
    assert skipped == []
    assert len(cases) == 12 + 4 + 1
    for case in cases:
        assert all(log.metadata.role == "test" for log in case.logs)
        assert all(log.metadata.role == "reference" for log in case.references)
        assert not {log.name for log in case.logs} & {log.name for log in case.references}
    doubled = next(c for c in cases if "XL330" in c.name and "double" in c.name)
    honest = next(c for c in cases if "XL330" in c.name and "as it is" in c.name)
    for wrong, true in zip(doubled.logs, honest.logs, strict=True):
        assert wrong.metadata.gains["servo"][0] == pytest.approx(
            2 * true.metadata.gains["servo"][0]
        )
    for case in (cases[0], cases[12], cases[-1]):
        subject = load_subject(case.robot, [*case.logs, *case.references])
        assert set(case.logs[0].joints) <= set(subject.joints)


@pytest.mark.slow
@pytest.mark.skipif(not data_folder().is_dir(), reason="the real logs are not on this machine")
def test_no_cause_is_named_on_real_logs_that_is_not_one():
    found = score_real(data_folder())
    wrong = [(row.name, row.said) for row in found.rows if row.said and not row.right]
    assert wrong == []
    assert sum(row.right for row in found.rows) >= 8
