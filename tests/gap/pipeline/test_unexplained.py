from types import SimpleNamespace

import numpy as np
import pytest
from noisy_channels import noisy_channel, noisy_scales

from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.pipeline.unexplained import Unexplained


def unexplained(noises, after, remainder=1.0, cycles=((), ()), verdict="unknown", odd=None):
    """Of channels with some noise over that of the references, and mean squares that are left."""
    channels = tuple(noisy_channel(name=name, residual="motion") for name in noises)
    scales = [noisy_scales(noise=noise) for noise in noises.values()]

    def log(joints):
        found = SimpleNamespace(
            joints=np.array([joint in joints for joint in noises]),
            frequency=np.full(len(noises), 9.0),
        )
        subject = SimpleNamespace(joints=tuple(noises))
        return SimpleNamespace(limit_cycle=found if joints else None, subject=subject)

    tests, references = cycles
    return Unexplained(
        SimpleNamespace(
            channels=channels,
            signals=(log(tests),),
            references=(log(references),),
            samples=SimpleNamespace(filtered_logs=(SimpleNamespace(rows=(), mask=()),) * 2),
        ),
        SimpleNamespace(
            hypothesis=SimpleNamespace(scales=tuple(scales), candidates=(), causes=()),
            odd=(),
            remainder=remainder,
            verdict=verdict,
        ),
        SimpleNamespace(
            after=np.array(after),
            noise=np.ones(len(noises)),
            odd=np.zeros(len(noises), bool) if odd is None else np.array(odd),
        ),
        InferenceRules(),
    )


def test_channels_that_scatter_are_named_the_noisiest_first():
    shapes = unexplained({"hip": 1.0, "knee": 400.0, "ankle": 1600.0}, [1.0, 1.0, 1.0]).shapes()
    assert [(shape["shape"], shape["location"]) for shape in shapes] == [
        ("noise", "ankle"),
        ("noise", "knee"),
    ]
    assert "40 times as much as in the references" in shapes[0]["says"]
    assert "20 times" in shapes[1]["says"]


def test_less_noise_than_before_is_nothing_to_explain():
    assert unexplained({"hip": 1e-4, "knee": 1.0}, [1.0, 1.0]).shapes() == ()


def test_an_answer_of_none_names_channels_that_scatter_more_than_in_the_references():
    noises = {"hip": 1.0, "knee": 2.25, "ankle": 4.0}
    quiet = [1.0, 1.0, 1.0]
    shapes = unexplained(noises, quiet, remainder=0.0, verdict="none").shapes()
    assert [(shape["shape"], shape["location"]) for shape in shapes] == [
        ("scatter", "ankle"),
        ("scatter", "knee"),
    ]
    assert "2 times as much as in the references" in shapes[0]["says"]
    assert unexplained(noises, quiet, remainder=0.0).shapes() == ()


def test_channels_that_are_left_larger_are_named_with_their_shares():
    shapes = unexplained({"hip": 1.0, "knee": 1.0, "ankle": 1.0}, [2.0, 1.0, 4.0]).shapes()
    assert [shape["location"] for shape in shapes] == ["ankle", "hip"]
    assert [shape["closed_beyond"] for shape in shapes] == pytest.approx([0.75, 0.25])
    assert unexplained({"hip": 1.0}, [2.0], remainder=0.0).shapes() == ()
    beside = unexplained({"hip": 1.0, "ankle": 1.0}, [2.0, 4.0], odd=[False, True]).shapes()
    assert [shape["location"] for shape in beside] == ["hip"]  # the ankle has a cause of its own


def test_a_limit_cycle_counts_where_the_references_lack_it():
    quiet = unexplained({"hip": 1.0, "knee": 1.0}, [1.0, 1.0])
    assert not quiet.hides_faults
    swinging = unexplained({"hip": 1.0, "knee": 1.0}, [1.0, 1.0], cycles=(("knee",), ()))
    assert swinging.hides_faults
    (shape,) = swinging.shapes()
    assert (shape["shape"], shape["location"]) == ("limit cycle", "knee")
    assert "9 Hz" in shape["says"]
    before = unexplained({"hip": 1.0, "knee": 1.0}, [1.0, 1.0], cycles=(("knee",), ("knee",)))
    assert not before.hides_faults
