"""Laws by name: what is registered is found, and a name without a law is refused."""

from __future__ import annotations

import os
from types import SimpleNamespace

import pytest

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.laws.laws import Laws


def design(law, source="a.yaml"):
    return SimpleNamespace(gears=SimpleNamespace(law=law), name="a", source=source)


def test_a_registered_law_is_found_and_the_later_one_counts():
    laws = Laws("gears")
    first, second = laws.register("one")(abs), laws.register("one")(len)
    assert (first, second) == (abs, len)  # a decorator leaves the function as it is
    assert laws.of(design("one")) is len
    assert Laws("gears").by_name == {}  # every kind has its own


def test_an_unknown_law_names_file_field_and_laws():
    laws = Laws("gears")
    laws.register("b")(abs)
    laws.register("a")(abs)
    with pytest.raises(InputError, match=r"^a\.yaml: gears\.law = 'c': expects one of a, b$"):
        laws.of(design("c"))
    with pytest.raises(InputError, match=r"^a: gears\.law"):
        laws.of(design("c", source=None))


def test_a_result_is_computed_once_for_each_design():
    laws, calls = Laws("gears"), []
    laws.register("catalogue")(lambda design: calls.append(design) or len(calls))
    robot, same = load_design("hyperleg"), load_design("hyperleg")
    assert [laws.result(robot), laws.result(robot), laws.result(same)] == [1, 1, 2]
    laws.register("catalogue")(lambda _: "another law")
    assert laws.result(robot) == "another law"


@pytest.mark.parametrize("leaf", ["actuators.knee.motor", "reference.knee_motor"])
def test_a_motor_whose_file_has_changed_gives_another_result(tmp_path, leaf):
    text = (resources.content_folder("motors") / "RI60.yaml").read_text().replace("RI60", "Mine")
    file = tmp_path / "Mine.yaml"
    file.write_text(text)
    laws, calls = Laws("gears"), []
    laws.register("catalogue")(lambda design: calls.append(design) or len(calls))
    robot = load_design("hyperleg", overrides={leaf: str(file)})
    assert [laws.result(robot), laws.result(robot)] == [1, 1]
    file.write_text(text + "\n")
    os.utime(file, ns=(0, file.stat().st_mtime_ns + 1))
    assert [laws.result(robot), laws.result(robot)] == [2, 2]
