"""MCAP containers, read front to back by the library `mcap` (https://mcap.dev)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from hyperleg_design.errors import InputError, in_short

MAGIC = b"\x89MCAP0\r\n"
MAX_RECORD = 1 << 30
"""Largest record that is unpacked [bytes]."""
INSTALL = "needs the libraries of ROS bags: pip install 'hyperleg-design[bags]'"


@dataclass(frozen=True)
class Message:
    """One message as stored."""

    topic: str
    type: str
    """Name of its schema."""
    encoding: str
    time: float
    """At which it was logged [s]."""
    data: bytes


def messages(path: Path, types: tuple[str, ...]) -> Iterator[Message]:
    """Read the messages of some types, in the file's order.

    Args:
        path: of the file.
        types: names of message types.

    Yields:
        The messages.

    Raises:
        InputError: damaged or cut short, or compressed in a way that is not known, or the library
            is not installed.
    """
    try:
        from mcap.exceptions import EndOfFile
        from mcap.records import Channel, Schema
        from mcap.records import Message as Record
        from mcap.stream_reader import StreamReader
    except ImportError:
        raise InputError(path.name, "", None, INSTALL) from None
    schemas: dict[int, str] = {}
    channels: dict[int, Channel] = {}
    try:
        with path.open("rb") as stream:
            for record in StreamReader(stream, record_size_limit=MAX_RECORD).records:
                if isinstance(record, Schema):
                    schemas[record.id] = record.name
                elif isinstance(record, Channel):
                    channels[record.id] = record
                elif isinstance(record, Record) and record.channel_id in channels:
                    channel = channels[record.channel_id]
                    kind = schemas.get(channel.schema_id, "")
                    if kind in types:
                        yield Message(
                            channel.topic,
                            kind,
                            channel.message_encoding,
                            record.log_time * 1e-9,
                            record.data,
                        )
    except EndOfFile:
        raise InputError(
            path.name, "", None, "is cut short: run `mcap recover` on it, or copy it again"
        ) from None
    except OSError as error:
        raise InputError(
            path.name, "", None, f"cannot be read ({error.strerror or error})"
        ) from None
    except Exception as error:
        # damaged bytes make the library and its decompressors raise anything
        raise InputError(path.name, "", None, f"is damaged ({in_short(error, 60)})") from None
