import json

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import write_log
from hyperleg_design.validation.baselines import table


def trial_of(rig, folder):
    """A blind trial's folder with one case, as `trial` writes it."""
    case = folder / "cases" / "000"
    (case / "logs").mkdir(parents=True)
    for number, log in enumerate(rig.logs):
        write_log(
            case / "logs" / f"{number}.parquet",
            log.changed(metadata=log.metadata.changed(robot="robot.xml")),
        )
    (case / "robot.xml").write_text(rig.path.read_text())
    (case / "case.json").write_text(
        json.dumps(
            {
                "robot": "robot.xml",
                "logs": [f"logs/{i}.parquet" for i in range(3)],
                "references": [],
            }
        )
    )
    seal = {"sha256": "0" * 64, "cases": 1, "seed": 0, "plants": ["rig"], "duration": [5, 5]}
    (folder / "seal.json").write_text(json.dumps(seal))


@pytest.mark.slow
def test_table_holds_gap_cause_and_time_and_leaves_the_key_alone(rig, tmp_path):
    trial_of(rig, tmp_path)
    found = table.baselines_table(tmp_path, methods=("diagnosis", "own"))
    own = next(e for e in found.entries if e.method == "own")
    assert own.right is None
    assert own.closed > 0.7
    assert own.effect in ("coulomb_friction", "viscous_friction", "rotor_inertia")
    assert next(e for e in found.entries if e.method == "diagnosis").stopped.startswith(
        "no diagnosis"
    )
    written = json.loads((tmp_path / "baselines.json").read_text())
    assert written["summary"][1]["method"] == "own"
    assert "sealed" in (tmp_path / "baselines.md").read_text()


def test_right_causes_count_also_by_their_other_names():
    truth = {
        "wrongs": [{"effect": "payload", "listed": True, "location": "hand", "also": ["wrist"]}]
    }
    assert table._right("payload", "wrist", truth)
    assert not table._right("payload", "elbow", truth)
    assert not table._right("", "", truth)
    assert table._right("", "", {"wrongs": []})
    assert not table._right(
        "coulomb_friction", "wrist", {"wrongs": [{"effect": "torque_ripple", "listed": False}]}
    )


@pytest.mark.parametrize(("methods", "cases"), [(("magic",), ()), ((), ()), (("own",), ("007",))])
def test_unknown_methods_and_cases_are_refused(rig, tmp_path, methods, cases):
    trial_of(rig, tmp_path)
    with pytest.raises(InputError):
        table.baselines_table(tmp_path, methods=methods, cases=cases)
