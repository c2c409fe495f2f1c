"""MCAP containers that the format's own library wrote."""

from __future__ import annotations

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.readers.mcap import MAGIC, messages

pytest.importorskip("mcap")
from mcap.writer import CompressionType, Writer

STATE, IMAGE = "sensor_msgs/msg/JointState", "sensor_msgs/msg/Image"
COUNT = 40


def write(path, compression=CompressionType.NONE, chunked=True):
    """Interleaved messages of two types on three topics."""
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=200, compression=compression, use_chunking=chunked)
        writer.start()
        channels = []
        for topic, kind in (("/legs", STATE), ("/camera", IMAGE), ("/arms", STATE)):
            schema = writer.register_schema(kind, "ros2msg", b"")
            channels.append(writer.register_channel(topic, "cdr", schema))
        for tick in range(COUNT):
            for channel in channels:
                time = 1_700_000_000_000_000_000 + tick * 5_000_000
                writer.add_message(channel, time, bytes([tick, channel]) * 4, time)
        writer.finish()
    return path


@pytest.mark.parametrize("chunked", [True, False])
@pytest.mark.parametrize(
    "compression", [CompressionType.NONE, CompressionType.LZ4, CompressionType.ZSTD]
)
def test_messages_of_the_types_come_in_the_files_order(tmp_path, compression, chunked):
    path = write(tmp_path / "log.mcap", compression, chunked)
    assert path.read_bytes().startswith(MAGIC)
    found = list(messages(path, (STATE,)))
    assert [one.topic for one in found] == ["/legs", "/arms"] * COUNT
    assert {(one.type, one.encoding) for one in found} == {(STATE, "cdr")}
    assert [one.data[0] for one in found] == [tick for tick in range(COUNT) for _ in range(2)]
    assert found[-1].time - found[0].time == pytest.approx((COUNT - 1) * 0.005, abs=1e-6)
    assert len(list(messages(path, (STATE, IMAGE)))) == 3 * COUNT
    assert list(messages(path, ())) == []


def test_a_file_that_is_cut_short_gives_what_it_holds_before_it_is_refused(tmp_path):
    path = write(tmp_path / "log.mcap")
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    read = []
    with pytest.raises(InputError, match=r"log\.mcap.*cut short"):
        read.extend(iter_into(read, messages(path, (STATE,))))
    assert 0 < len(read) < 2 * COUNT


def iter_into(kept, found):
    for one in found:
        kept.append(one)
    return []


@pytest.mark.parametrize("content", [b"", MAGIC, b"#ROSBAG V2.0\n" * 20, MAGIC + b"\x7f" * 200])
def test_what_is_no_such_file_is_refused(tmp_path, content):
    path = tmp_path / "odd.mcap"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"odd\.mcap"):
        list(messages(path, (STATE,)))


def test_damaged_bytes_are_refused_or_change_no_more_than_data(tmp_path):
    path = write(tmp_path / "log.mcap", CompressionType.ZSTD)
    whole = bytearray(path.read_bytes())
    refused = 0
    for place in range(20, len(whole), 97):
        changed = bytearray(whole)
        changed[place] ^= 0xFF
        path.write_bytes(changed)
        try:
            list(messages(path, (STATE,)))
        except InputError:
            refused += 1
    assert refused > 5


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"absent\.mcap.*No such file"):
        list(messages(tmp_path / "absent.mcap", (STATE,)))
