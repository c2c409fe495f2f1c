"""Tensors saved by torch, read without torch and without running anything that the file asks
for.
"""

from __future__ import annotations

import io
import pickle
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError, in_short

STORAGES = {
    "DoubleStorage": "f8",
    "FloatStorage": "f4",
    "HalfStorage": "f2",
    "LongStorage": "i8",
    "IntStorage": "i4",
    "ShortStorage": "i2",
    "CharStorage": "i1",
    "ByteStorage": "u1",
    "BoolStorage": "?",
}
"""Kinds of numbers by torch's class of storage."""
MAX_BYTES = 1 << 30
"""Largest tensor that is read."""


class _Refused(Exception):
    pass


class _Storage:
    def __init__(self, kind: str) -> None:
        self.kind = kind


class _Unpickler(pickle.Unpickler):
    """Knows tensors, their storages and ordered dictionaries; everything else is refused."""

    def __init__(self, data: bytes, archive: zipfile.ZipFile, prefix: str, order: str) -> None:
        super().__init__(io.BytesIO(data))
        self._archive, self._prefix, self._order = archive, prefix, order

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) in (
            ("torch._utils", "_rebuild_tensor_v2"),
            ("torch._utils", "_rebuild_tensor"),
        ):
            return _tensor
        if (module, name) == ("collections", "OrderedDict"):
            return dict
        if module == "torch" and name in STORAGES:
            return _Storage(STORAGES[name])
        raise _Refused(f"it holds {module}.{name}")

    def persistent_load(self, pid: Any) -> np.ndarray:
        if (
            not isinstance(pid, tuple)
            or len(pid) < 5
            or pid[0] != "storage"
            or not isinstance(pid[1], _Storage)
        ):
            raise _Refused("it holds a storage of unknown kind")
        entry = f"{self._prefix}/data/{pid[2]}"
        if self._archive.getinfo(entry).file_size > MAX_BYTES:
            raise _Refused(f"a tensor is larger than {MAX_BYTES >> 20} MiB")
        kind = np.dtype(self._order + pid[1].kind)
        return np.frombuffer(self._archive.read(entry), kind)


def _tensor(
    storage: np.ndarray, offset: int, size: tuple[int, ...], stride: tuple[int, ...], *_: Any
) -> np.ndarray:
    last = (
        offset + sum((n - 1) * s for n, s in zip(size, stride, strict=True))
        if all(size)
        else offset - 1
    )
    if offset < 0 or min(stride, default=0) < 0 or last >= len(storage):
        raise _Refused("a tensor reaches past its data")
    strides = [s * storage.itemsize for s in stride]
    return np.lib.stride_tricks.as_strided(storage[offset:], size, strides, writeable=False).copy()


def read_tensors(path: Path) -> dict[str, Any]:
    """Read the dictionary that `torch.save` wrote.

    Args:
        path: of the file.

    Returns:
        Its entries; tensors are NumPy arrays.

    Raises:
        InputError: damaged, of the old format, holding anything but tensors, numbers, texts, lists
        and dictionaries.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            inside = next(
                (n for n in archive.namelist() if n.count("/") == 1 and n.endswith("/data.pkl")), ""
            )
            if not inside:
                raise InputError(path.name, "", None, "is a zip file but no file of torch.save")
            prefix = inside.rsplit("/", 1)[0]
            order = "<"
            if (
                f"{prefix}/byteorder" in archive.namelist()
                and archive.read(f"{prefix}/byteorder").strip() == b"big"
            ):
                order = ">"
            content = _Unpickler(archive.read(inside), archive, prefix, order).load()
    except _Refused as error:
        raise InputError(
            path.name, "", None, f"is not read: {error}; save a dictionary of plain tensors"
        ) from None
    except InputError:
        raise
    except Exception as error:  # a damaged pickle may fail in any way
        raise InputError(
            path.name, "", None, f"is damaged ({in_short(error, 80)}): save it again"
        ) from None
    if not isinstance(content, dict):
        raise InputError(path.name, "", type(content).__name__, "expects a dictionary of tensors")
    return content
