from __future__ import annotations

from pathlib import Path

import pytest

from hyperleg_design import resources
from hyperleg_design.errors import InputError


@pytest.mark.parametrize("kind", resources.CONTENT)
def test_content_folders_are_there(kind):
    assert resources.content_folder(kind).is_dir()


def test_a_shipped_name_and_a_path_are_found(tmp_path: Path, monkeypatch):
    assert resources.find("descriptions", "hyperleg").name == "hyperleg.yaml"
    own, bare = tmp_path / "own.yaml", tmp_path / "robot"
    own.touch()
    bare.touch()
    assert resources.find("descriptions", own) == own
    assert resources.find("descriptions", bare) == bare  # a path needs no ending
    monkeypatch.chdir(tmp_path)
    assert resources.find("descriptions", "own.yaml") == Path("own.yaml")
    (tmp_path / "hyperleg").touch()
    assert (
        resources.find("descriptions", "hyperleg").name == "hyperleg.yaml"
    )  # a stray file does not hide what is shipped


@pytest.mark.parametrize(
    "name", ["no_such", "no/such.yaml", "", ".", "..", "../motors/RI70", "x" * 5000, "a\0b", "/tmp"]
)
def test_what_is_not_there_lists_what_is(name):
    with pytest.raises(InputError, match=r"hyperleg|cannot be read"):
        resources.find("descriptions", name)


def test_a_misspelt_name_is_answered_by_the_nearest():
    with pytest.raises(InputError, match=r"'toe_mas': no such file; did you mean toe_mass\?$"):
        resources.find("sweeps", "toe_mas")
    with pytest.raises(InputError, match=r"did you mean walk_free\?$"):
        resources.find_sim("task", "walk_fre")


def test_unknown_kind_is_a_mistake_of_ours():
    with pytest.raises(ValueError, match="descriptions"):
        resources.content_folder("robots")


def test_home_is_overridden_by_the_environment(monkeypatch, tmp_path: Path):
    (tmp_path / "descriptions").mkdir()
    (tmp_path / "descriptions" / "mine.yaml").touch()
    monkeypatch.setenv("HYPERLEG_HOME", str(tmp_path))
    assert resources.names("descriptions") == ["mine"]
    monkeypatch.setenv("HYPERLEG_HOME", str(tmp_path / "nowhere"))
    with pytest.raises(InputError, match="HYPERLEG_HOME"):
        resources.home()


@pytest.mark.parametrize("what", ["task", "preset", "protocol"])
def test_shipped_simulation_files_are_found_by_name(what):
    for name in resources.sim_names(what):
        assert resources.find_sim(what, name).name == f"{what}_{name}.yaml"
    with pytest.raises(InputError, match=resources.sim_names(what)[0]):
        resources.find_sim(what, "nothing-of-the-kind")
