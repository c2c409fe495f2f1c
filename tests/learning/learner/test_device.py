"""Updates on another device: nothing is lost on the way there and back."""

import json

import pytest

from hyperleg_design.errors import InputError

pytest.importorskip("torch")

from hyperleg_design.learning.learner.device import check_device
from hyperleg_design.learning.train import train


def _losses(folder, preset, device):
    train("walk", "toe_locked", 1, preset, folder, iterations=2, device=device)
    lines = (folder / "progress.jsonl").read_text().splitlines()
    return [(each["reward"], each["losses"]) for each in map(json.loads, lines)]


def test_an_update_on_another_device_is_the_same_update(tiny, tmp_path):
    """`cpu:0` is the processor by another name, so all is moved and the numbers must not change."""
    here, there = tmp_path / "here", tmp_path / "there"
    assert _losses(here, tiny, "cpu") == _losses(there, tiny, "cpu:0")


@pytest.mark.parametrize("device", ["foo", "cuda:99", ""])
def test_a_device_that_is_not_there_is_an_error(device):
    with pytest.raises(InputError, match=r"--device.*no such device"):
        check_device(device)


def test_a_preset_that_cannot_learn_elsewhere_says_so(tmp_path):
    with pytest.raises(InputError, match=r"--device.*adapted: iteration, not paper"):
        train("walk_paper", "toe", 0, "paper", tmp_path / "run", device="cpu:0")
    assert not (tmp_path / "run").exists()
