from __future__ import annotations

from pathlib import Path

from hyperleg_design.learning.records.status import POLICY, STATUS, policies, read_status


def test_policies_come_earliest_first_the_final_one_last(tmp_path: Path) -> None:
    assert policies(tmp_path) == []
    for name in (POLICY, "late_000900.onnx", "late_000800.onnx", "other.onnx"):
        (tmp_path / name).touch()
    assert [p.name for p in policies(tmp_path)] == ["late_000800.onnx", "late_000900.onnx", POLICY]


def test_a_status_half_written_or_missing_is_none(tmp_path: Path) -> None:
    assert read_status(tmp_path) is None
    (tmp_path / STATUS).write_text('{"steps": 1')
    assert read_status(tmp_path) is None
    (tmp_path / STATUS).write_text('{"steps": 1}')
    assert read_status(tmp_path) == {"steps": 1}
