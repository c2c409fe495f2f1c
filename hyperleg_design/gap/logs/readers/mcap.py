"""MCAP containers: schemas, channels and messages, in chunks or not, read front to back
(https://mcap.dev/spec).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from hyperleg_design.errors import InputError, in_short

MAGIC = b"\x89MCAP0\r\n"
SCHEMA, CHANNEL, MESSAGE, CHUNK, DATA_END = 3, 4, 5, 6, 15
"""Opcodes that matter here."""
MAX_CHUNK = 1 << 30
"""Largest chunk that is unpacked."""


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
    """Messages of some types, in the file's order.

    Raises:
        InputError: damaged or cut short, or compressed in a way that is not known.
    """
    schemas: dict[int, str] = {}
    channels: dict[int, tuple[str, int, str]] = {}

    def from_records(records: Iterator[tuple[int, bytes]]) -> Iterator[Message]:
        for code, body in records:
            if code == SCHEMA:
                (number,) = struct.unpack_from("<H", body)
                schemas[number] = _text(body, 2)[0]
            elif code == CHANNEL:
                number, schema = struct.unpack_from("<HH", body)
                topic, place = _text(body, 4)
                channels[number] = (topic, schema, _text(body, place)[0])
            elif code == MESSAGE:
                number, _, time, _ = struct.unpack_from("<HIQQ", body)
                topic, schema, encoding = channels.get(number, ("", 0, ""))
                if schemas.get(schema) in types:
                    yield Message(topic, schemas[schema], encoding, time * 1e-9, body[22:])

    try:
        size = path.stat().st_size
        with path.open("rb") as stream:
            if stream.read(len(MAGIC)) != MAGIC:
                raise InputError(path.name, "", None, "is no MCAP file")
            while True:
                head = stream.read(9)
                code, length = (
                    (head[0], struct.unpack_from("<Q", head, 1)[0]) if len(head) == 9 else (0, size)
                )
                if length > size - stream.tell():
                    raise InputError(
                        path.name,
                        "",
                        None,
                        "is cut short: run `mcap recover` on it, or copy it again",
                    )
                if code == DATA_END:
                    return
                if code not in (SCHEMA, CHANNEL, MESSAGE, CHUNK):
                    stream.seek(length, 1)
                    continue
                body = stream.read(length)
                yield from from_records(
                    _records(_unpacked(body, path.name)) if code == CHUNK else iter([(code, body)])
                )
    except (struct.error, UnicodeDecodeError, IndexError) as error:
        raise InputError(path.name, "", None, f"is damaged ({error})") from None
    except OSError as error:
        raise InputError(
            path.name, "", None, f"cannot be read ({error.strerror or error})"
        ) from None


def _records(data: bytes) -> Iterator[tuple[int, bytes]]:
    place = 0
    while place < len(data):
        (length,) = struct.unpack_from("<Q", data, place + 1)
        if place + 9 + length > len(data):
            raise struct.error("a record reaches past its chunk")
        yield data[place], data[place + 9 : place + 9 + length]
        place += 9 + length


def _unpacked(body: bytes, where: str) -> bytes:
    """Records of a chunk."""
    import pyarrow

    _, _, size, _ = struct.unpack_from("<QQQI", body)
    compression, place = _text(body, 28)
    (length,) = struct.unpack_from("<Q", body, place)
    packed = body[place + 8 : place + 8 + length]
    if not compression:
        return packed
    if compression not in ("zstd", "lz4"):
        raise InputError(
            where, "compression", compression, "is not known; compress with zstd or lz4"
        )
    if size > MAX_CHUNK:
        raise InputError(where, "chunk", size, "is larger than 1 GiB when unpacked")
    try:
        return pyarrow.decompress(packed, decompressed_size=size, codec=compression, asbytes=True)
    except (pyarrow.ArrowException, OSError, ValueError) as error:
        raise InputError(where, "chunk", None, f"is damaged ({in_short(error, 60)})") from None


def _text(data: bytes, place: int) -> tuple[str, int]:
    (length,) = struct.unpack_from("<I", data, place)
    if place + 4 + length > len(data):
        raise struct.error("a text reaches past its record")
    return data[place + 4 : place + 4 + length].decode("utf-8"), place + 4 + length
