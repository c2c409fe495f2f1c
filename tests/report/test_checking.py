from __future__ import annotations

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.report.checking import check_paths, checks_text


def test_shipped_things_of_every_kind_are_good():
    found = check_paths(["hyperleg", "toe_removed", "RI70", "toe_mass"])
    assert [f["errors"] for f in found] == [0, 0, 0, 0]
    assert checks_text(found).count("good") == 4


def test_a_broken_sweep_is_found(tmp_path):
    path = tmp_path / "broken.yaml"
    path.write_text("design: hyperleg\nsampling: grid\naxes: {toe.mas: {values: [0.1, 0.2]}}\n")
    (found,) = check_paths([str(path)])
    assert found["errors"] == 1
    assert "toe.mas" in checks_text([found])
    assert "1 error, 0 warnings" in checks_text([found])


def test_a_broken_design_is_found(tmp_path):
    path = tmp_path / "broken.yaml"
    path.write_text("base: hyperleg\ntoe: {mass: -1}\n")
    (found,) = check_paths([str(path)])
    assert found["errors"] == 1
    assert "toe.mass" in checks_text([found])


@pytest.mark.parametrize("paths", [[], ["hyperleg", "nothing-here"]])
def test_what_names_nothing_is_bad_input(paths):
    with pytest.raises(InputError):
        check_paths(paths)
