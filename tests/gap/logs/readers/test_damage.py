"""Whatever happens to a file on its way, opening it gives logs or one clear error."""

import io
import json
import zipfile

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.readers import open_log


def parquet():
    sink = io.BytesIO()
    time = np.arange(300) * 0.01
    pyarrow.parquet.write_table(pyarrow.table({"t": time, "position/knee": np.sin(time)}), sink)
    return sink.getvalue()


def tensors():
    sink = io.BytesIO()
    with zipfile.ZipFile(sink, "w") as target:
        item = (
            "ctorch._utils\n_rebuild_tensor_v2\n((Vstorage\nctorch\nDoubleStorage\nV{}\nVcpu\nI20\ntQI0\n"
            "(I20\n{}t(I{}\n{}tI00\nccollections\nOrderedDict\n)RtR"
        )
        text = (
            "(dVtime\n"
            + item.format(0, "", 1, "")
            + "sVdof_pos\n"
            + item.format(1, "I1\n", 1, "I1\n")
            + "s."
        )
        target.writestr("x/data.pkl", text)
        target.writestr("x/data/0", np.arange(20.0).tobytes())
        target.writestr("x/data/1", np.sin(np.arange(20.0)).tobytes())
    return sink.getvalue()


def table():
    return b"t,position/knee [deg],velocity/knee\n" + b"".join(
        b"%d,%d,1\n" % (i, i * i) for i in range(50)
    )


def recording():
    entries = [
        {"timestamp": i * 0.005, "position": 0.1, "goal_position": 0.2, "speed": 0.0, "load": 3}
        for i in range(30)
    ]
    return json.dumps(
        {"mass": 1, "length": 0.1, "kp": 100, "vin": 7.4, "motor": "xl330", "entries": entries}
    ).encode()


SOUND = {"log.parquet": parquet(), "log.pt": tensors(), "log.csv": table(), "log.json": recording()}


@pytest.mark.parametrize("name", SOUND)
def test_sound_files_open(tmp_path, name):
    (tmp_path / name).write_bytes(SOUND[name])
    (log,) = open_log(tmp_path / name)
    assert len(log.time) >= 20


@pytest.mark.parametrize("name", SOUND)
@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_damaged_files(tmp_path_factory, name, data):
    content = bytearray(SOUND[name])
    for _ in range(data.draw(st.integers(0, 3))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(content)))
    path = tmp_path_factory.mktemp("damage") / name
    path.write_bytes(bytes(content[:cut] if data.draw(st.booleans()) else content))
    error, found = opened(path)
    assert not error or error.startswith(name)
    assert all(np.isfinite(log.time).all() and len(log.joints) for log in found)


def opened(path):
    """The error's text and the logs; any other error than ours goes through."""
    try:
        return "", open_log(path)
    except InputError as error:
        return str(error), []


@settings(max_examples=60, deadline=None)
@given(
    content=st.binary(max_size=400),
    head=st.sampled_from(
        [
            b"",
            b"PAR1",
            b"PK\x03\x04",
            b"\x89MCAP0\r\n",
            b"SQLite format 3\0",
            b"{",
            b"t,position/a\n",
        ]
    ),
)
def test_any_bytes(tmp_path_factory, content, head):
    path = tmp_path_factory.mktemp("bytes") / "log.bin"
    path.write_bytes(head + content)
    error, found = opened(path)
    assert "log.bin" in error or "state_motor.csv" in error or found
