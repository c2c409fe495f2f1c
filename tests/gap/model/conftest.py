"""Robots of all kinds, for what must hold for each."""

import pytest

from hyperleg_design.gap.signals.loading import load_subject


@pytest.fixture(
    scope="module",
    params=[
        "hyperleg",
        "toe_locked",
        "toe_removed",
        "mini_cheetah",
        "parallel_ankle",
        "teaching_leg",
        "arm",
        "coupled",
        "pendulum",
    ],
)
def subject(request, robot_files):
    return load_subject(robot_files.get(request.param, request.param))
