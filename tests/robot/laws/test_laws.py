"""Laws by name: what is registered is found, and a name without a law is refused."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from hyperleg_design.errors import InputError
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
