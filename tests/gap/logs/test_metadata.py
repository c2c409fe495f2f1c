import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.metadata import Metadata, metadata_from_mapping


def test_unknown_keys_are_kept():
    found = metadata_from_mapping(
        {"robot": "hyperleg", "operator": "me", "extra": {"a": 1}}, "run.json"
    )
    assert found.extra == {"operator": "me", "a": 1}
    assert metadata_from_mapping(found.mapping(), "run.json") == found


def test_what_is_written_is_plain():
    found = Metadata(
        gains={"knee": np.array([20, 1.5])},
        torque_constant={"m": np.float32(0.5)},
        gravity=np.array([0, 0, -9.81]),
    )
    assert found.gains == {"knee": (20.0, 1.5)}
    assert found.mapping() == {"gains": {"knee": [20.0, 1.5]}, "torque_constant": {"m": 0.5}}


def test_overrides_and_payload_in_both_spellings():
    found = metadata_from_mapping(
        {
            "overrides": {"toe.mass": 0.3},
            "payload": {"hand": [1, [0, 0, 0.1]], "foot": [2, 0, 0, 0]},
        },
        "x",
    )
    assert found.overrides == ("toe.mass=0.3",)
    assert found.payload == {"hand": (1, 0, 0, 0.1), "foot": (2, 0, 0, 0)}


def test_remarks_stand_once():
    assert Metadata().remarked("a", "b").remarked("a").remarks == ("a", "b")


@pytest.mark.parametrize(
    ("content", "place"),
    [
        ({"base": "flying"}, "base = 'flying': expects fixed or floating"),
        ({"role": "best"}, "role"),
        ({"targets": "still"}, "targets = 'still': expects kept or moving"),
        ({"torque_sensors": "knee"}, "torque_sensors = 'knee': expects a list of texts"),
        ({"gravity": [0, 0]}, "gravity.*3 numbers"),
        ({"gravity": [0, 0, -9810]}, "gravity.*m/s"),
        ({"gains": {"knee": [1]}}, "gains.knee.*2 numbers"),
        ({"gains": {"knee": [-1, 2]}}, "gains.knee.*neither negative"),
        ({"gains": [1, 2]}, "gains.*names with values"),
        ({"gains": {"knee": [1, "a"]}}, "gains.knee = 'a'.*finite number"),
        ({"torque_constant": {"m": 0}}, "torque_constant.m.*above 0"),
        ({"torque_constant": {"m": float("nan")}}, "torque_constant.m.*finite"),
        ({"supply": {"m": [7.4, 0, 8]}}, "supply.m.*above 0"),
        ({"supply": {"m": 7.4}}, "supply.m.*3 numbers"),
        ({"payload": {"hand": [-1, 0, 0, 0]}}, "payload.hand.*mass"),
        ({"payload": {"hand": 2.0}}, "payload.hand.*4 numbers"),
        ({"robot": 3}, "robot.*text"),
        ({"notes": None}, "notes.*text"),
        ({"overrides": "toe.mass=1"}, "overrides.*list"),
        ([], "names with values"),
    ],
)
def test_bad_values(content, place):
    with pytest.raises(InputError, match=place) as error:
        metadata_from_mapping(content, "run.json")
    assert str(error.value).startswith("run.json")
