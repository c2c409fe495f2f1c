import json

import pytest

from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.gap.results.diagnosis import (
    SCHEMA_FILE,
    Diagnosis,
    Named,
    Place,
    Shrinkage,
    Value,
    read_diagnosis,
)
from hyperleg_design.writing import write_json


def example(**changes):
    values = {
        "verdict": "explained",
        "gap": Shrinkage(1.0, 0.2, 0.1, 0.888888888, (0.8, 0.95), "Nm"),
        "where": (Place("knee", "joint", "all", 0.9), Place("knee", "joint", "slow", 0.6)),
        "causes": (
            Named("coulomb_friction", "knee", 0.9, 0.88, {"torque": Value(1.9, 1.7, 2.1, "Nm")}),
        ),
        "rivals": (
            Named(
                "viscous_friction", "knee", 0.05, 0.4, {"damping": Value(0.3, 0.2, 0.4, "Nms/rad")}
            ),
        ),
        "equivalent": ((("coulomb_friction", "knee"), ("backlash", "knee")),),
        "separating_experiment": {"name": "preload"},
    }
    return Diagnosis(**{**values, **changes})


def test_a_diagnosis_survives_its_file(tmp_path):
    path = write_json(tmp_path / "diagnosis.json", example().mapping())
    assert read_diagnosis(path).mapping() == example().mapping()


def test_the_file_keeps_its_schema(tmp_path):
    validate = pytest.importorskip("jsonschema").validate
    schema = json.loads(SCHEMA_FILE.read_text())
    for one in (
        example(),
        example(verdict="none", causes=(), equivalent=(), separating_experiment=None),
    ):
        path = write_json(tmp_path / "diagnosis.json", one.mapping())
        validate(json.loads(path.read_text()), schema)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("{", "not JSON"),
        ("[]", "schema"),
        ('{"schema": 2}', "version"),
        ('{"schema": 1, "verdict": "perhaps"}', "verdict"),
        ('{"schema": 1, "verdict": "none"}', "whole"),
        ('{"schema": 1, "verdict": "none", "gap": 3}', "whole"),
    ],
)
def test_what_is_no_diagnosis_is_refused(tmp_path, content, says):
    path = tmp_path / "diagnosis.json"
    path.write_text(content)
    with pytest.raises(InputError, match=says):
        read_diagnosis(path)
    with pytest.raises(InputError, match="read"):
        read_diagnosis(tmp_path / "none.json")


def test_a_number_that_is_not_finite_is_never_written(tmp_path):
    wrong = example(gap=Shrinkage(float("nan"), 0, 0, 0, (0, 0), "Nm"))
    with pytest.raises(OutputError):
        write_json(tmp_path / "d.json", wrong.mapping())
    assert not (tmp_path / "d.json").exists()
