import io
import os
import pickle
import zipfile
from collections import OrderedDict

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.readers.pickle_tensors import read_tensors


def test_what_torch_saves_is_read_without_it(tmp_path):
    torch = pytest.importorskip("torch")
    base = torch.arange(24.0).reshape(4, 6)
    content = {
        "a": base,
        "b": base.T,
        "c": base[1:, ::2],
        "d": torch.tensor([1, 2]),
        "e": torch.tensor(3.0, dtype=torch.float64),
        "names": ["x"],
        "n": 2,
    }
    torch.save(content, tmp_path / "x.pt")
    found = read_tensors(tmp_path / "x.pt")
    for key in "abcde":
        np.testing.assert_array_equal(found[key], content[key].numpy())
    assert (found["names"], found["n"]) == (["x"], 2)


def archive(path, data, **files):
    with zipfile.ZipFile(path, "w") as target:
        target.writestr("x/data.pkl", data)
        for name, content in files.items():
            target.writestr(f"x/data/{name}", content)
    return path


class Malice:
    def __reduce__(self):
        return os.system, ("touch /tmp/never",)


@pytest.mark.parametrize("content", [Malice(), np.ones(3), io.StringIO()])
def test_nothing_is_run(tmp_path, content):
    try:
        data = pickle.dumps({"a": content}, protocol=2)
    except TypeError:
        pytest.skip("cannot be pickled")
    with pytest.raises(InputError, match=r"x.pt: is not read: it holds"):
        read_tensors(archive(tmp_path / "x.pt", data))


def pickled(size, stride, offset=0):
    """The bytes that torch would write of one tensor of ten doubles."""
    # written by hand: protocol 0 text is easy to make and to read
    ints = lambda values: "(" + "".join(f"I{v}\n" for v in values) + "t"  # noqa: E731
    text = (
        "(dVa\nctorch._utils\n_rebuild_tensor_v2\n((Vstorage\nctorch\nDoubleStorage\nV0\nVcpu\nI10\ntQ"
        f"I{offset}\n{ints(size)}{ints(stride)}I00\nccollections\nOrderedDict\n)RtRs."
    )
    return text.encode()


def test_bounds_of_tensors(tmp_path):
    numbers = np.arange(10.0).tobytes()
    found = read_tensors(archive(tmp_path / "x.pt", pickled((3, 2), (2, 1), 2), **{"0": numbers}))
    np.testing.assert_array_equal(found["a"], np.arange(2.0, 8).reshape(3, 2))
    for size, stride, offset in (
        ((6, 2), (2, 1), 0),
        ((3,), (1,), 8),
        ((2,), (-1,), 5),
        ((2,), (1,), -1),
    ):
        with pytest.raises(InputError, match="reaches past"):
            read_tensors(
                archive(tmp_path / "x.pt", pickled(size, stride, offset), **{"0": numbers})
            )


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\x80\x02garbage",
        pickle.dumps([1], protocol=2),
        pickle.dumps(OrderedDict(a=1), protocol=2)[:-3],
    ],
)
def test_damage(tmp_path, data):
    with pytest.raises(InputError, match=r"x.pt"):
        read_tensors(archive(tmp_path / "x.pt", data))


def test_other_zip_files(tmp_path):
    with zipfile.ZipFile(tmp_path / "x.pt", "w") as target:
        target.writestr("readme.txt", "hello")
    with pytest.raises(InputError, match=r"no file of torch\.save"):
        read_tensors(tmp_path / "x.pt")
    (tmp_path / "x.pt").write_bytes(b"PK\x03\x04 cut")
    with pytest.raises(InputError, match="damaged"):
        read_tensors(tmp_path / "x.pt")
