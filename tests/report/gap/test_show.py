"""Text and figure of a shown effect."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.playback import show as module
from hyperleg_design.gap.playback.show import effects_table, show
from hyperleg_design.report.gap.show import effects_text, show_figure, show_summary, show_text


@pytest.fixture(scope="module")
def shown():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "DURATION", 4.0)
        return show("viscous_friction")


def test_text_names_every_effect_with_its_numbers():
    text = effects_text(effects_table())
    for name, one in EFFECTS.items():
        assert f"{name}  ({one.kind})" in text
        for parameter in one.parameters:
            assert f"    {parameter.name}: {0 if parameter.choices else parameter.null:g}" in text
    assert max(map(len, text.splitlines())) < 160


def test_summary_is_what_was_shown(shown):
    summary = show_summary(shown)
    assert summary["effect"] == "viscous_friction"
    assert summary["parameters"]["damping"] == {"value": shown.values[0], "unit": "Nms/rad"}
    assert summary["unit"] == "Nm"
    known = np.isfinite(shown.trace)
    assert summary["trace_rms"] == pytest.approx(
        np.sqrt(np.mean(shown.trace[known] ** 2)), rel=0.02
    )
    assert summary["closed_loop_rms"] > 0
    text = show_text({**summary, "figure": "a.png"})
    assert "viscous_friction at joint of servo_rig" in text
    assert text.endswith("a.png")
    assert "no trace" in show_text({**summary, "residual": ""})


def test_figure_is_drawn_the_same_each_time_and_without_a_trace_too(shown, tmp_path):
    import dataclasses

    one, again = (show_figure(shown, tmp_path / f"{name}.png").read_bytes() for name in "ab")
    assert one == again
    assert one.startswith(b"\x89PNG")
    nothing = np.full_like(shown.trace, np.nan)
    empty = dataclasses.replace(shown, residual_name="", row="", trace=nothing, residual=nothing)
    assert show_figure(empty, tmp_path / "empty.png").stat().st_size > 10_000
