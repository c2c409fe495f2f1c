import numpy as np
import pyarrow
import pyarrow.parquet
import pytest

from hyperleg_design.gap.logs import blocks
from hyperleg_design.gap.logs.log import Log, read_log, write_log


def example(ticks: int = 50, **signals: np.ndarray) -> Log:
    time = np.arange(ticks) * 0.005
    return Log(
        "run", time, {"position/knee": np.sin(time), "motor_current/m": np.cos(time), **signals}
    )


def write_table(path, **columns):
    pyarrow.parquet.write_table(pyarrow.table(columns), path)
    return path


def test_recordings_too_long_for_memory_are_read_in_blocks(tmp_path, monkeypatch):
    monkeypatch.setattr(blocks, "BLOCK_ROWS", 100)
    path = write_log(tmp_path / "run.parquet", example(5000))
    monkeypatch.setattr(blocks, "MAX_VALUES", 3 * 1050)
    found = read_log(path)
    assert len(found.time) == 1000
    assert found.step == pytest.approx(0.005)
    assert found.duration > 0.85 * 25
    np.testing.assert_allclose(found.signals["position/knee"], np.sin(found.time))
    assert any("1000 of its 5000 rows" in remark for remark in found.metadata.remarks)


def test_long_recordings_of_one_row_group(tmp_path, monkeypatch):
    monkeypatch.setattr(blocks, "BLOCK_ROWS", 100)
    time = np.arange(5050) * 0.01
    path = write_table(tmp_path / "run.parquet", **{"t": time, "position/knee": time})
    monkeypatch.setattr(blocks, "MAX_VALUES", 2 * 1000)
    found = read_log(path)
    assert len(found.time) == 1000
    np.testing.assert_array_equal(found.signals["position/knee"], found.time)
