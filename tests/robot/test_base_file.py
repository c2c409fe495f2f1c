"""Bases of design files by name and by path."""

from __future__ import annotations

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.load import family_of, load_robot


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder of a command, with a design in `robots/` below it."""
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots" / "dog.yaml").write_text(
        "base: mini_cheetah\nlinks: {trunk: {mass: 5.0}}\n"
    )
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("file", "base"),
    [
        ("robots/mine.yaml", "dog"),
        ("robots/mine.yaml", "dog.yaml"),
        ("robots/mine.yaml", "./dog.yaml"),
        ("robots/mine.yaml", "robots/dog.yaml"),
        ("robots/mine.yaml", "robots/dog"),
        ("others/mine.yaml", "../robots/dog.yaml"),
        ("others/mine.yaml", "robots/dog.yaml"),
        ("mine.yaml", "robots/dog.yaml"),
    ],
)
def test_a_path_counts_from_the_file_or_from_the_command(folder, file, base):
    path = folder / file
    path.parent.mkdir(exist_ok=True)
    path.write_text(f"base: {base}\nactuators: {{knee: {{gear: 8}}}}\n")
    assert family_of(path) == "tree"
    design = load_robot(file)
    assert (design["links.trunk.mass"], design["actuators.knee.gear"]) == (5.0, 8.0)
    assert design.bases == ("dog", "mini_cheetah")


def test_a_path_of_a_hyperleg(folder):
    (folder / "robots" / "biped.yaml").write_text("base: hyperleg\ntoe: {mass: 0.3}\n")
    (folder / "mine.yaml").write_text("base: robots/biped.yaml\nfoot: {mass: 0.7}\n")
    design = load_robot("mine.yaml")
    assert (design["toe.mass"], design["foot.mass"]) == (0.3, 0.7)


def test_the_file_beside_goes_before_that_of_the_command(folder):
    (folder / "dog.yaml").write_text("base: mini_cheetah\nlinks: {trunk: {mass: 6.0}}\n")
    (folder / "robots" / "mine.yaml").write_text("base: dog.yaml\n")
    assert load_robot("robots/mine.yaml")["links.trunk.mass"] == 5.0


@pytest.mark.parametrize("base", ["robots/cat.yaml", "../cat", "/", "dogs/dog.yaml"])
def test_a_path_that_is_nowhere_names_file_and_field(folder, base):
    (folder / "mine.yaml").write_text(f"base: {base}\n")
    with pytest.raises(InputError, match=r"mine\.yaml: base = .*no such design, neither from"):
        load_robot("mine.yaml")


def test_a_path_that_is_too_long_is_refused(folder):
    (folder / "mine.yaml").write_text(f"base: {'a' * 300}.yaml\n")
    with pytest.raises(InputError, match=r"mine\.yaml: base"):
        load_robot("mine.yaml")


def test_the_near_names_are_those_of_designs(folder):
    for name, text in {
        "dog_sweep": "design: dog\naxes: {links.trunk.mass: {values: [3, 4]}}\n",
        "dog_protocol": "kind: walk\nseeds: [1]\n",
        "dog_preset": "base: walker\niterations: 3\n",
        "dog_broken": "base: [\n",
        "dog_circle": "base: dog_circle\n",
        "dog_heavy": "base: dog\n",
    }.items():
        (folder / "robots" / f"{name}.yaml").write_text(text)
    path = folder / "robots" / "mine.yaml"
    path.write_text("base: zzzzz\n")
    with pytest.raises(InputError) as caught:
        load_robot(path)
    known = caught.value.remedy.split("there are ")[1].split(", ")
    assert {"dog", "dog_heavy", "hyperleg", "mini_cheetah"} <= set(known)
    assert not {"dog_sweep", "dog_protocol", "dog_preset", "dog_broken", "dog_circle"} & set(known)
