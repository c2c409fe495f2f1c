"""The XL330 servo: what is declared wrongly, and which logs are references."""

from __future__ import annotations

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.validation.real import xl330
from hyperleg_design.validation.real.cases import data_folder

DATA = data_folder()


def needs(folder):
    return pytest.mark.skipif(
        not (DATA / folder).is_dir(), reason=f"{DATA / folder} with the real logs is absent"
    )


@needs(xl330.FOLDER)
def test_xl330_declares_gain_constant_and_mass_as_the_truth_says():
    right = {log.name: log for log in xl330.material(DATA, "sin_sin", "nothing", "no")[0].logs}
    assert len(right) == 4
    for fault, what in (("gain_double", "gains"), ("constant_high", "torque_constant")):
        material, truth = xl330.material(DATA, "sin_sin", fault, "no")
        (value,) = truth.faults[0].parameters.values()
        for log in material.logs:
            told, true = log.metadata[what]["servo"], right[log.name].metadata[what]["servo"]
            if what == "gains":
                told, true = told[0], true[0]
            assert true / told == pytest.approx(value)
    light, truth = xl330.material(DATA, "sin_sin", "mass_light", "other")
    told = light.logs[0].metadata["payload"]["arm"][0]
    true = light.references[0].metadata["payload"]["arm"][0]
    assert true - told == pytest.approx(truth.faults[0].parameters["mass"])


@needs(xl330.FOLDER)
def test_xl330_references_are_of_the_motion_that_is_asked_for_and_of_no_tested_recording():
    for references, count in (("same", 2), ("other", 4), ("no", 0)):
        material, truth = xl330.material(DATA, "up_and_down", "nothing", references)
        kinds = {log.metadata["trajectory"] for log in material.references}
        expected = {"same": {"up_and_down"}, "other": {"sin_sin"}, "no": set()}
        assert kinds == expected[references]
        assert len(material.references) == count
        assert truth.references == bool(count)
        names = {log.name for log in material.logs}
        assert not names & {log.name for log in material.references}


def test_xl330_without_recordings_is_told(tmp_path):
    with pytest.raises(InputError, match="no recordings"):
        xl330.material(tmp_path, "sin_sin", "nothing", "no")
