"""Reading designs of any family."""

from __future__ import annotations

import json
import pickle
import shlex
from pathlib import Path

import numpy as np
import pytest
import yaml

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.build import build
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.load import design_argument, load_robot, robot_from_mapping
from tests.robot.tree_files import leg


def test_the_example_of_the_page_loads(tmp_path):
    page = (Path(__file__).parents[2] / "docs" / "robots.md").read_text()
    path = tmp_path / "mine.yaml"
    path.write_text(page.split("```yaml\n")[1].split("```")[0])
    assert transmission.joint_names(load_robot(path)) == ("hip", "knee")


def test_a_file_may_build_on_another(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("base: mini_cheetah\nactuators: {knee: {gear: 8}}\n")
    design = load_robot(path)
    assert (design.name, design["actuators.knee.gear"]) == ("mine", 8.0)
    assert pickle.loads(pickle.dumps(design)).bases == design.bases == ("mini_cheetah",)
    path.write_text(yaml.safe_dump({"family": "octopus"}))
    with pytest.raises(InputError, match=r"family.*octopus.*hyperleg, tree"):
        load_robot(path)
    with pytest.raises(InputError, match="no variants"):
        load_robot("mini_cheetah", variant="toe_locked")


@pytest.mark.parametrize("base", ["mini_cheetah", "hyperleg"])
def test_a_printed_argument_finds_the_design_from_where_it_was_read(base, tmp_path, monkeypatch):
    (tmp_path / "deep" / "two words").mkdir(parents=True)
    (tmp_path / "beside").mkdir()
    file = tmp_path / "deep" / "two words" / "mine.yaml"
    file.write_text(f"base: {base}\nname: rex\ncontact: {{friction: 0.6}}\n")
    for folder, given in (
        (tmp_path, "deep/two words/mine.yaml"),
        (tmp_path / "beside", "../deep/two words/mine.yaml"),
        (tmp_path, str(file)),
    ):
        monkeypatch.chdir(folder)
        design = load_robot(given).with_values({"contact.friction": np.array([0.4, 0.5])})
        for copy in (design.take(1), pickle.loads(pickle.dumps(design))):
            (argument,) = shlex.split(design_argument(copy))
            assert load_robot(argument)["contact.friction"] == 0.6


def test_a_shipped_design_and_one_of_no_file_are_named():
    assert design_argument(load_robot("mini_cheetah")) == "mini_cheetah"
    assert design_argument(load_robot("mini_cheetah").with_values({"links.trunk.mass": 4.0})) == (
        "mini_cheetah"
    )
    assert design_argument(robot_from_mapping(leg().to_mapping(), "here")) == leg().name


def test_designs_travel_to_other_processes_and_back_from_mappings():
    design = leg().with_values({"links.shank.mass": np.array([1.0, 2.0])})
    again = pickle.loads(pickle.dumps(design))
    assert np.array_equal(again["links.shank.mass"], [1.0, 2.0])
    assert again.origins == design.origins
    one = design.take(1)
    assert robot_from_mapping(one.to_mapping(), "here").to_mapping() == one.to_mapping()


def test_what_needs_hyperleg_refuses_another_family_and_says_so():
    with pytest.raises(InputError, match=r"mini_cheetah\.yaml.*family.*another family.*load_robot"):
        load_design("mini_cheetah")


def test_a_sweep_is_no_design(tmp_path):
    path = tmp_path / "sweep.yaml"
    path.write_text("design: hyperleg\naxes: {toe.mass: {values: [0.1, 0.2]}}\n")
    with pytest.raises(InputError, match=r"sweep\.yaml: axes: belongs to a sweep"):
        load_robot(path)


@pytest.mark.parametrize("family", ["", "family: tree\n"])
def test_a_base_that_is_nowhere_names_its_file_and_the_nearest(tmp_path, family):
    (tmp_path / "my_dog.yaml").write_text("base: mini_cheetah\n")
    path = tmp_path / "mine.yaml"
    for base, near in (("my_dgo", "my_dog"), ("mini_cheeta", "mini_cheetah")):
        path.write_text(f"{family}base: {base}\n")
        with pytest.raises(InputError, match=rf"mine\.yaml: base = .*did you mean {near}\?"):
            load_robot(path)
    path.write_text(f"{family}base: 3\n")
    with pytest.raises(InputError, match=r"mine\.yaml: base"):
        load_robot(path)


@pytest.mark.parametrize("design", ["toe", "mini_cheetah"])
def test_a_set_file_that_is_not_there_is_named_as_one(design, tmp_path):
    for name, reason in (("nosuch.yaml", "no such file"), (tmp_path, "is a folder")):
        with pytest.raises(InputError, match=f"--set-file = '{name}': {reason}.*differ$"):
            load_robot(design, overlays=[name])


@pytest.mark.parametrize("ending", [".urdf", ".xml", ".mjcf"])
def test_a_file_that_import_takes_is_sent_there(ending, tmp_path):
    path = tmp_path / f"bolt{ending}"
    path.write_text("<robot name='bolt'/>")
    with pytest.raises(InputError, match=rf"^{path}: is no design; hyperleg import makes one"):
        load_robot(path)


def test_errors_name_the_path_as_given_and_results_the_folder_alone(tmp_path, monkeypatch):
    folder = tmp_path / "results" / "bad"
    folder.mkdir(parents=True)
    (folder / "a.yaml").write_text(yaml.safe_dump(leg().to_mapping()))
    (folder / "heavy.yaml").write_text("links: {shank: {mass: -1}}")
    (folder / "light.yaml").write_text("links: {shank: {mass: 0.5}}")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=r"^results/bad/heavy\.yaml: links\.shank\.mass = -1"):
        load_robot("results/bad/a.yaml", overlays=["results/bad/heavy.yaml"])
    design = load_robot("results/bad/a.yaml").with_values(
        {"links.shank.mass": 0.5}, "results/bad/light.yaml"
    )
    assert design.source == "results/bad/a.yaml"
    assert design.origins["links.shank.mass"].source == "bad/light.yaml"
    manifest = json.loads((build(design, tmp_path / "out") / "manifest.json").read_text())
    assert manifest["source"] == "bad/a.yaml"


def test_a_motor_named_by_a_path_is_blamed_by_it(tmp_path, monkeypatch):
    (tmp_path / "deep" / "own").mkdir(parents=True)
    (tmp_path / "deep" / "own" / "Mine.yaml").write_text("constants: {}\n")
    design = leg().to_mapping()
    design["actuators"]["knee"]["motor"] = "own/Mine.yaml"
    (tmp_path / "deep" / "leg.yaml").write_text(yaml.safe_dump(design))
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=r"^deep/own/Mine\.yaml: "):
        load_robot("deep/leg.yaml")
