"""The Go2's leg: reference and test of one recording."""

from __future__ import annotations

import pytest

from hyperleg_design.validation.real import go2
from hyperleg_design.validation.real.cases import data_folder

DATA = data_folder()


def needs(folder):
    return pytest.mark.skipif(
        not (DATA / folder).is_dir(), reason=f"{DATA / folder} with the real logs is absent"
    )


@needs(go2.FOLDER)
def test_go2_is_parted_into_reference_and_test_and_one_gain_is_wrong():
    material, truth = go2.material(DATA, "gain_double_thigh", True)
    (test,), (reference,) = material.logs, material.references
    assert reference.time[-1] <= go2.HALF <= test.time[0]
    wrong = [j for j in go2.JOINTS if test.metadata["gains"][j] != reference.metadata["gains"][j]]
    assert wrong == ["FL_thigh_joint"]
    assert truth.faults[0].parameters["stiffness_scale"] == 0.5
    whole, truth = go2.material(DATA, "nothing", False)
    assert len(whole.logs[0].time) > len(test.time)
    assert truth.kind == "nothing"
