from __future__ import annotations

import pytest

from hyperleg_design.report.style import figure_style, save


@pytest.mark.parametrize("kind", ["png", "svg"])
def test_the_same_figure_has_the_same_bytes(tmp_path, kind):
    files = []
    for name in "ab":
        with figure_style():
            import matplotlib.pyplot as plt

            figure, axes = plt.subplots()
            axes.plot([0, 1], [0, 1])
            files.append(save(figure, tmp_path / f"{name}.{kind}").read_bytes())
    assert files[0] == files[1]
    assert len(files[0]) > 1000
