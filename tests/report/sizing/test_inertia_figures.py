import numpy as np
import pytest
from matplotlib.colors import to_hex

from hyperleg_design.errors import InputError
from hyperleg_design.report.sizing.inertia_figures import (
    ROD,
    comparison_rows,
    leg_comparison_figure,
)
from hyperleg_design.report.style import VARIANT_COLOUR, save
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.names import VARIANTS
from hyperleg_design.sizing.inertia import leg_inertia
from hyperleg_design.sizing.other_robots import SOURCES, compare


@pytest.fixture(scope="module")
def designs():
    return [load_design("hyperleg", variant=variant) for variant in VARIANTS]


def test_equal_legs_share_a_row_and_all_robots_are_there(designs):
    rows = comparison_rows(designs)
    assert len(rows) == 2 + len(SOURCES)
    own = [row for row in rows if row.own]
    assert {row.colour for row in own} == {VARIANT_COLOUR["toe"], VARIANT_COLOUR["toe_removed"]}
    together = next(row for row in own if "toe_locked" in row.label)
    assert "toe_removed_matched" in together.label
    order = [row.leg.inertia_over_leg for row in rows]
    assert order == sorted(order)


def test_bars_have_the_length_of_their_values(designs):
    rows = comparison_rows(designs)
    figure = leg_comparison_figure(designs)
    expected = (
        [100 * r.leg.distal_share for r in rows],
        [r.leg.inertia_over_leg for r in rows],
        [1e3 * r.leg.inertia_over_total for r in rows],
    )
    for axis, values in zip(figure.axes, expected, strict=True):
        bars = axis.patches[: len(rows)]
        np.testing.assert_allclose([b.get_width() for b in bars], np.nan_to_num(values))
        assert [to_hex(b.get_facecolor()) for b in bars] == [row.colour for row in rows]
        assert "[" in axis.get_xlabel()
    assert sum("unknown" in text.get_text() for text in figure.axes[2].texts) == sum(
        not s.whole for s in SOURCES
    )
    assert [line.get_xdata()[0] for line in figure.axes[1].lines] == [ROD]


def test_one_design_can_stand_beside_chosen_robots(tmp_path):
    design = load_design("hyperleg", overrides={"toe.mass": 0.3})
    rows = comparison_rows([design], compare(["Talos", "Human"]))
    assert {row.label for row in rows} == {"hyperleg: toe", "Talos", "Human"}
    assert next(r for r in rows if r.own).leg.swing_inertia == leg_inertia(design).swing_inertia
    for ending in ("png", "svg"):
        assert (
            save(
                leg_comparison_figure([design], compare(["Talos"])),
                tmp_path / f"bars.{ending}",
                dpi=40,
            )
            .stat()
            .st_size
            > 4000
        )
    assert (
        save(leg_comparison_figure([design], ()), tmp_path / "own.png", dpi=40).stat().st_size
        > 2000
    )


def test_bad_input_is_refused():
    with pytest.raises(InputError, match="at least one design"):
        leg_comparison_figure([])
    with pytest.raises(InputError, match="batch"):
        leg_comparison_figure(
            [load_design("hyperleg").with_values({"toe.mass": np.array([0.2, 0.3])})]
        )
