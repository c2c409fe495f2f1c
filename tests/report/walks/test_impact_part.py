"""Impacts over the stiffness of the sole: pads, peaks, and what cannot be told."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.report.page import Picture, Table
from hyperleg_design.report.walks import impact_part
from hyperleg_design.report.walks.impact_part import impacts
from tests.report.conftest import of_kind


def test_the_pad_is_a_spring_and_damper_of_the_stated_mass(found, draw):
    """K = m / (zeta T)^2 and damping 2 m / T of the time constants 10 and 20 ms."""
    content = impacts(found, draw).content
    text = content[0]
    assert "12 mm of a soft sole on 9.0 cm²" in text
    assert "is 4 times as stiff as the last" in text
    mass = float(text.split("effective mass of ")[1].split(" kg")[0])
    (table,) = of_kind(content, Table)
    stiff, own = table.rows
    assert stiff[0] == "10 ms"
    assert own[0] == "20 ms (all else here)"
    contact = found.evaluations[0].trials[0].design.contact_section
    for row, constant in ((stiff, 0.01), (own, 0.02)):
        stiffness = mass / (float(contact.damping_ratio) * constant) ** 2
        assert row[1] == pytest.approx(stiffness / 1e3, rel=1e-2)
        assert row[2] == pytest.approx(2 * mass / constant, rel=1e-2)
        assert row[3] * 1e6 * 9.05e-4 / 0.012 == pytest.approx(1e3 * row[1], rel=1e-2)
    (picture,) = of_kind(content, Picture)
    assert (draw.folder / picture.file).stat().st_size > 10_000


def test_peaks_are_those_of_the_walks_and_falls_are_counted(found, draw):
    (table,) = of_kind(impacts(found, draw).content, Table)
    for k, design in enumerate(found.band):
        peaks = [e.values("grf_peak_body_weights") for e in found.band[design][0.02]]
        assert table.rows[1][4 + k].startswith(f"{np.nanmean(peaks):.3g}")
    assert "1 fell" in table.rows[0][4]
    assert "fell" not in table.rows[0][5]


def test_one_design_has_no_difference(found, draw):
    alone = dataclasses.replace(found, band={"toe": found.band["toe"]})
    (table,) = of_kind(impacts(alone, draw).content, Table)
    assert [row[-1] for row in table.rows] == ["–", "–"]


def test_without_a_step_no_mass_is_told(found, draw, monkeypatch):
    monkeypatch.setattr(impact_part, "measured_steps", lambda trial, events: ())
    (text,) = impacts(found, draw).content
    assert text.startswith("Cannot be told")
