from __future__ import annotations

from hyperleg_design.errors import HyperlegError
from hyperleg_design.report.drawer import Drawer
from hyperleg_design.report.page import Missing, Picture


def test_a_figure_that_cannot_be_drawn_costs_only_itself(tmp_path):
    draw = Drawer(tmp_path, "policy_")

    def fails(path):
        raise HyperlegError("no OpenGL")

    assert draw("gait", "A gait.", fails) == Missing("A gait.", "no OpenGL")
    made = draw(
        "walk",
        "A walk.",
        lambda path: (path.parent.mkdir(), path.write_text("x")),
        ".gif",
        wide=False,
    )
    assert made == Picture("figures/policy_walk.gif", "A walk.", False, True)
    assert (tmp_path / "figures" / "policy_walk.gif").exists()
    both = draw.together(
        [
            (
                name,
                f"{name}.",
                fails if name == "b" else lambda path: path.write_text("x"),
                ".gif",
                False,
            )
            for name in "abc"
        ]
    )
    assert [type(one) for one in both] == [Picture, Missing, Picture]
    assert [one.caption for one in both] == ["a.", "b.", "c."]
    assert not any(one.chart for one in both if isinstance(one, Picture))  # only lines are inverted
