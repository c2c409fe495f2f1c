import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log, write_log
from hyperleg_design.gap.logs.readers import open_log


def example(name):
    time = np.arange(10) * 0.01
    return Log(name, time, {"position/knee": np.sin(time)})


def test_a_folder_of_logs(tmp_path):
    write_log(tmp_path / "b.parquet", example("b"))
    write_log(tmp_path / "a.parquet", example("a"))
    (tmp_path / "a.json").write_text('{"session": "monday"}')
    (tmp_path / "c.csv").write_text("t,position/knee\n0,1\n1,2\n")
    found = open_log(tmp_path)
    assert [log.name for log in found] == ["a", "b", "c"]
    assert found[0].metadata.session == "monday"
    assert found[0].folder == str(tmp_path)


def test_given_metadata_win(tmp_path):
    path = write_log(tmp_path / "a.parquet", example("a"))
    (log,) = open_log(path, metadata={"session": "x", "gains": {"knee": [1, 2]}})
    assert (log.metadata.session, log.metadata.gains) == ("x", {"knee": (1, 2)})
    with pytest.raises(InputError, match=r"gains.knee"):
        open_log(path, metadata={"gains": {"knee": [1]}})


def test_what_cannot_be_opened(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        open_log(tmp_path / "none")
    with pytest.raises(InputError, match="holds no logs"):
        open_log(tmp_path)
    (tmp_path / "a.pt").write_bytes(b"")
    with pytest.raises(InputError, match="is an empty file"):
        open_log(tmp_path / "a.pt")
    (tmp_path / "a.bin").write_bytes(b"\1\2\0\3" * 200)
    with pytest.raises(InputError, match="no known format: expects Parquet"):
        open_log(tmp_path / "a.bin")
    (tmp_path / "a.parquet").write_bytes(b"\1\2\0\3" * 200)
    with pytest.raises(InputError, match="no whole Parquet"):
        open_log(tmp_path / "a.parquet")
