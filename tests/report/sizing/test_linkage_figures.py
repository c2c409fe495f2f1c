from __future__ import annotations

import numpy as np

from hyperleg_design.report.sizing.linkage_figures import linkage_figure
from hyperleg_design.robot.design import load_design


def test_printed_postures_lie_on_the_curves():
    figure = linkage_figure(load_design("hyperleg"))
    printed = {(26.0, 26.69), (24.14, 19.23), (31.93, 21.27)}
    for axis, (standing, walking) in zip(
        figure.axes, sorted(printed, key=lambda p: [26.0, 24.14, 31.93].index(p[0])), strict=True
    ):
        curves = [line for line in axis.lines if len(line.get_xdata()) > 2]
        points = [line for line in axis.lines if len(line.get_xdata()) == 1]
        assert [float(p.get_ydata()[0]) for p in points] == [standing, walking]
        for point in points:
            x, y = float(point.get_xdata()[0]), float(point.get_ydata()[0])
            gaps = [abs(np.interp(x, c.get_xdata(), c.get_ydata()) - y) for c in curves]
            assert min(gaps) < 0.02
