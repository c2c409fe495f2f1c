"""The SO-101 arm: one gain or a load declared wrongly."""

from __future__ import annotations

import pytest

from hyperleg_design.validation.real import so101
from hyperleg_design.validation.real.cases import data_folder

DATA = data_folder()


def needs(folder):
    return pytest.mark.skipif(
        not (DATA / folder).is_dir(), reason=f"{DATA / folder} with the real logs is absent"
    )


@needs(so101.FOLDER)
def test_so101_declares_one_gain_or_a_load_wrongly():
    right, _ = so101.material(DATA, "nothing", True)
    wrong, truth = so101.material(DATA, "gain_half_elbow_flex", True)
    for joint in so101.JOINTS:
        ratio = (
            right.logs[0].metadata["gains"][joint][0] / wrong.logs[0].metadata["gains"][joint][0]
        )
        assert ratio == pytest.approx(2.0 if joint == "elbow_flex" else 1.0)
    assert truth.faults[0].parameters["stiffness_scale"] == 2.0
    assert wrong.references[0].metadata["gains"] == right.references[0].metadata["gains"]
    loaded, truth = so101.material(DATA, "load_declared", False)
    assert loaded.logs[0].metadata["payload"]["gripper_link"][0] == pytest.approx(
        -truth.faults[0].parameters["mass"]
    )
    assert not loaded.references
