from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hyperleg_design.errors import InputError, OutputError

torch = pytest.importorskip("torch")

from hyperleg_design.learning.records.checkpoint import load_checkpoint, save_checkpoint  # noqa: E402


def test_everything_comes_back_bit_for_bit(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    rng.normal(size=5)
    content = {
        "networks": {"weight": torch.randn(3, 2, generator=torch.Generator().manual_seed(1))},
        "environment": {
            "chunks": [
                {
                    "x": rng.normal(size=(4, 3)),
                    "on": np.array([True, False]),
                    "random": rng.bit_generator.state,
                    "goal": None,
                }
            ]
        },
        "count": np.int64(3),
        "seconds": 1.25,
    }
    save_checkpoint(tmp_path / "c.pt", content)
    again = load_checkpoint(tmp_path / "c.pt")
    assert torch.equal(again["networks"]["weight"], content["networks"]["weight"])
    chunk, expected = again["environment"]["chunks"][0], content["environment"]["chunks"][0]
    np.testing.assert_array_equal(chunk["x"], expected["x"])
    np.testing.assert_array_equal(chunk["on"], expected["on"])
    assert chunk["goal"] is None
    assert (again["count"], again["seconds"]) == (3, 1.25)
    fresh = np.random.default_rng()
    fresh.bit_generator.state = chunk["random"]
    assert fresh.normal() == rng.normal()


def test_missing_truncated_and_foreign_files_are_named(tmp_path: Path) -> None:
    path = tmp_path / "c.pt"
    with pytest.raises(InputError, match="no such checkpoint"):
        load_checkpoint(path)
    save_checkpoint(path, {"networks": {"w": torch.ones(1000)}})
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(InputError, match="truncated"):
        load_checkpoint(path)
    path.write_bytes(b"")
    with pytest.raises(InputError, match="truncated"):
        load_checkpoint(path)
    torch.save({"weights": 1}, path)
    with pytest.raises(InputError, match="hyperleg-checkpoint-1"):
        load_checkpoint(path)


def test_a_file_cannot_run_code(tmp_path: Path) -> None:
    import pickle

    class Evil:
        def __reduce__(self):
            return (Path.touch, (tmp_path / "touched",))

    (tmp_path / "c.pt").write_bytes(pickle.dumps({"format": "hyperleg-checkpoint-1", "x": Evil()}))
    with pytest.raises(InputError):
        load_checkpoint(tmp_path / "c.pt")
    assert not (tmp_path / "touched").exists()


def test_a_full_disk_leaves_the_old_checkpoint(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import os

    path = tmp_path / "c.pt"
    save_checkpoint(path, {"count": 1})

    def full(handle: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OutputError, match="No space left"):
        save_checkpoint(path, {"count": 2})
    assert load_checkpoint(path)["count"] == 1
    assert [p.name for p in tmp_path.iterdir()] == ["c.pt"]
