import json

import numpy as np

from hyperleg_design.sweep.searching.plain_values import plain_values


def test_a_row_survives_json_and_what_is_no_number_becomes_none():
    row = {"a": np.float64(0.5), "b": np.int64(3), "c": np.nan, "d": np.float32(np.inf), "e": "x"}
    found = plain_values({**row, 7: np.bool_(True)})
    assert found == {"a": 0.5, "b": 3, "c": None, "d": None, "e": "x", "7": True}
    assert json.loads(json.dumps(found, allow_nan=False)) == found
