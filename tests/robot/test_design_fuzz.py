"""Whatever stands in a design file, the answer is a design or one clear error."""

from __future__ import annotations

import copy
import datetime
import random
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.linkage import LinkageModel
from hyperleg_design.robot.mass.inertials import inertials
from hyperleg_design.robot.transmission import max_joint_torque

SOURCE = (resources.content_folder("descriptions") / "hyperleg.yaml").read_bytes()
DATA = yaml.load(SOURCE, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))


def _places(data: dict, prefix: tuple = ()) -> list[tuple]:
    found = []
    for key, value in data.items():
        found.append((*prefix, key))
        if isinstance(value, dict):
            found += _places(value, (*prefix, key))
    return found


PLACES = _places(DATA)
JUNK = st.one_of(
    st.sampled_from(
        [
            None,
            True,
            "",
            "x",
            "1 m",
            "nan",
            ".inf",
            [],
            {},
            [1, 2, 3],
            {"value": 3},
            {"value": None},
            {"a": {"b": 1}},
            [[0, 0, 0]],
            10**400,
            0,
            -1,
        ]
    ),
    st.sampled_from(
        [
            1e-12,
            1e12,
            datetime.date(2020, 1, 1),
            b"\x00\xff",
            [None, None, None],
            [float("nan")] * 3,
            "RI70",
            "walking",
            "locked",
            "shank",
        ]
    ),
    st.floats(),
    st.floats(-2, 50),
    st.integers(),
    st.text(max_size=5),
)


def used(path: Path, *, linkage: bool) -> None:
    """Load a file and compute from it; anything but an input error of one line escapes."""
    try:
        design = load_design(path)
        numbers = [inertials(design)["thigh"].inertia, max_joint_torque(design)]
        if linkage:
            LinkageModel.of(design)
    except InputError as error:
        check(error)
    else:
        assert all(np.all(np.isfinite(n)) for n in numbers)


def check(error: InputError) -> None:
    assert error.remedy
    assert "\n" not in str(error)
    assert len(str(error)) < 1200


@pytest.fixture(scope="module")
def file(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("fuzz") / "robot.yaml"


@given(st.data())
@settings(max_examples=150)
def test_any_leaf_replaced_by_anything(file, data):
    made = copy.deepcopy(DATA)
    for _ in range(data.draw(st.integers(1, 2))):
        place = data.draw(st.sampled_from(PLACES))
        part = made
        for key in place[:-1]:
            part = part[key] if isinstance(part, dict) and key in part else {}
        if isinstance(part, dict):
            part[place[-1]] = data.draw(JUNK)
    file.write_text(yaml.dump(made, Dumper=getattr(yaml, "CSafeDumper", yaml.SafeDumper)))
    used(file, linkage=place[:2] == ("transmission", "linkage"))


@given(st.integers(0, 2**32), st.integers(1, 5))
@settings(max_examples=150)
def test_any_bytes_changed(file, seed, count):
    dice = random.Random(seed)
    content = bytearray(SOURCE)
    for _ in range(count):
        index = dice.randrange(len(content))
        action = dice.randrange(3)
        if action == 0:
            content[index] = dice.randrange(256)
        elif action == 1:
            del content[index : index + dice.randrange(1, 40)]
        else:
            content[index:index] = bytes(
                dice.choices(b"\n\t :{}[],'\"-#&*!|>%@`0.", k=dice.randrange(1, 5))
            )
    file.write_bytes(bytes(content))
    used(file, linkage=False)


@given(
    st.dictionaries(
        st.sampled_from([".".join(p) for p in PLACES if p[-1] not in ("value", "label", "source")])
        | st.text(max_size=5),
        JUNK,
        max_size=3,
    )
)
@settings(max_examples=80)
def test_any_override(hyperleg, values):
    try:
        hyperleg.with_values(values)
    except InputError as error:
        check(error)
