"""The page itself: a viser server with robots, sliders, charts and a walk's controls."""

from __future__ import annotations

import contextlib
import io
import threading
import time
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import HyperlegError, InputError
from hyperleg_design.report.viewer import charts
from hyperleg_design.report.viewer.masses import masses_text
from hyperleg_design.report.viewer.needs import check_installed, check_port
from hyperleg_design.report.viewer.scene import RobotView
from hyperleg_design.report.viewer.sliders import HIGHEST, LOWEST, changed, parameters_of
from hyperleg_design.robot.kinematics.dimensions import total_mass
from hyperleg_design.robot.kinematics.posture import default_angles, link_poses, lowest_point
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.models import GRAVITY

if TYPE_CHECKING:
    from hyperleg_design.report.viewer.walk import RecordedWalk
    from hyperleg_design.robot.parameters.described import RobotDesign

MOST_DESIGNS = 2
"""Side by side."""
FRAME_RATE = 25.0
"""Of a walk as it is played [1/s]."""
CHART_TIME = 0.5
"""Between updates of a chart's operating point while a walk plays [s]."""
_GAP = 0.9
"""Between two robots, over the taller one's height [-]."""
_CELL, _SECTION = (215, 218, 224), (180, 185, 195)
"""Colours of the floor's lines in the light scheme."""


class Viewer:
    """A running page; `close` ends it."""

    def __init__(
        self,
        designs: Mapping[str, RobotDesign],
        walk: RecordedWalk | None = None,
        *,
        host: str = "localhost",
        port: int = 8080,
        dark: bool = False,
    ) -> None:
        """Start the server and build the page.

        Args:
            designs: one or two robots by label; the first one plays the walk, and so does a second
                one that has its joints.
            walk: a recorded motion of the first robot.
            host: address to listen on.
            port: to listen on.
            dark: begin with the dark scheme.

        Raises:
            InputError: a package is missing, the port is taken, or the number of designs.
        """
        check_installed()
        if not 1 <= len(designs) <= MOST_DESIGNS:
            raise InputError("view", "designs", len(designs), "expects one design or two")
        check_port(host, port)
        import viser

        self._loaded = dict(designs)
        self.designs: dict[str, RobotDesign] = dict(designs)
        """As the sliders have them, by label."""
        self._walk = walk
        self._lock = threading.RLock()
        self._stop = threading.Event()
        self._sliders: dict[str, dict[str, Any]] = {}
        self._moved = {label: threading.Event() for label in designs}
        with contextlib.redirect_stdout(io.StringIO()):  # viser prints a banner
            self.server = viser.ViserServer(host, port, label="hyperleg view", verbose=False)
        self.url = f"http://{host}:{self.server.get_port()}"
        height = max(_height(d) for d in designs.values())
        self._scale = 0.4 * height
        self._views = {
            label: RobotView(self.server, f"/{index}", (0.0, -_GAP * height * index, 0.0))
            for index, label in enumerate(designs)
        }
        try:
            self._build_scene(height)
            self._build_page(dark)
        except BaseException:
            self.server.stop()
            raise
        self._worker = threading.Thread(target=self._work, daemon=True)
        self._worker.start()

    def close(self) -> None:
        """Stop playing, and the server."""
        self._stop.set()
        self._worker.join(timeout=5.0)
        with contextlib.redirect_stdout(io.StringIO()):
            self.server.stop()

    def wait(self) -> None:
        """Serve until the user interrupts."""
        try:
            while not self._stop.wait(3600.0):
                pass
        finally:
            self.close()

    def _build_scene(self, height: float) -> None:
        scene = self.server.scene
        scene.set_up_direction("+z")
        self._grid = scene.add_grid("/floor", infinite_grid=True, cell_size=0.25, section_size=1.0)
        middle = np.array([0.0, -_GAP * height * (len(self._views) - 1) / 2, 0.5 * height])
        camera = self.server.initial_camera
        camera.look_at = tuple(middle)
        camera.position = tuple(middle + height * np.array([1.5, -1.2, 0.45]))
        for label, view in self._views.items():
            view.show(self.designs[label])
        if len(self._views) > 1:
            for index, label in enumerate(self._views):
                place = (0.0, -_GAP * height * index, 1.1 * height)
                scene.add_label(f"/name{index}", label, position=place, anchor="bottom-center")

    def _build_page(self, dark: bool) -> None:
        gui = self.server.gui
        gui.set_panel_label("hyperleg view")
        self._dark = gui.add_checkbox("Dark scheme", dark)
        self._dark.on_update(lambda _: self._restyle())
        if self._walk is not None:
            self._build_player()
        self._message = gui.add_markdown("", visible=False)
        tabs = gui.add_tab_group()
        with tabs.add_tab("Masses"):
            self._masses = gui.add_markdown("")
        with tabs.add_tab("Motors"):
            motors = charts.motors_of(list(self.designs.values()))
            first = "knee" if "knee" in motors else motors[0]
            self._motor = gui.add_dropdown("Motor", motors, initial_value=first)
            self._motor_chart = gui.add_plotly(self._motor_figure(), aspect=1.1)
            self._motor.on_update(lambda _: self._refresh_motor())
        with tabs.add_tab("Torques"):
            pairs = {
                f"{a}, {b}".replace("_", " "): (a, b)
                for d in self.designs.values()
                for a, b in charts.joint_pairs(d)
            }
            self._pairs = pairs
            self._pair = gui.add_dropdown("Joints", list(pairs))
            self._slice_chart = gui.add_plotly(self._slice_figure(), aspect=1.1)
            self._pair.on_update(lambda _: self._refresh_slices())
        for label, design in self._loaded.items():
            self._build_sliders(label, design)
        self._restyle()

    def _build_sliders(self, label: str, design: RobotDesign) -> None:
        gui, sliders = self.server.gui, self._sliders.setdefault(label, {})
        with gui.add_folder(f"Change {label}"):
            reset = gui.add_button("Reset")
            groups: dict[str, Any] = {}
            for parameter in parameters_of(design):
                if parameter.group not in groups:
                    groups[parameter.group] = gui.add_folder(
                        f"{parameter.group}, × unchanged", expand_by_default=False
                    )
                with groups[parameter.group]:
                    slider = gui.add_slider(
                        parameter.label,
                        min=LOWEST,
                        max=HIGHEST,
                        step=0.05,
                        initial_value=1.0,
                        hint=f"unchanged: {parameter.value:.4g} {parameter.unit}".strip(),
                    )
                slider.on_update(lambda _: self._moved[label].set())
                sliders[parameter.label] = slider
        reset.on_click(lambda _: self._reset(label))

    def _reset(self, label: str) -> None:
        for slider in self._sliders[label].values():
            if slider.value != 1.0:
                slider.value = 1.0
        self.rebuild(label)

    def _build_player(self) -> None:
        assert self._walk is not None
        gui = self.server.gui
        with gui.add_folder("Walk"):
            gui.add_markdown(self._walk.caption)
            self._playing = gui.add_checkbox("Play", True)
            self._speed = gui.add_slider("Speed", min=0.1, max=2.0, step=0.1, initial_value=1.0)
            self._time = gui.add_slider(
                "Time [s]",
                min=0.0,
                max=round(max(self._walk.duration, 0.02), 2),
                step=0.01,
                initial_value=0.0,
            )
            self._forces = gui.add_markdown("")
        self._time.on_update(self._dragged)

    def _dragged(self, event: Any) -> None:
        """Show the time that a user chose; what the page sets itself it shows itself."""
        if event.client is not None:
            self.show_time(self._time.value)

    def set_slider(self, label: str, parameter: str, factor: float) -> None:
        """Move a slider as a user would.

        Args:
            label: of the design.
            parameter: label of the slider.
            factor: to put it to [-].

        Raises:
            InputError: no such design or slider.
        """
        try:
            self._sliders[label][parameter].value = factor
        except KeyError:
            known = ", ".join(self._sliders.get(label, self._sliders))
            raise InputError("view", label, parameter, f"expects one of: {known}") from None
        self.rebuild(label)

    def rebuild(self, label: str) -> None:
        """Make the robot that the sliders describe; if it cannot be made, the page states why and
        the robot stays.

        Args:
            label: of the robot.
        """
        with self._lock:
            factors = {name: slider.value for name, slider in self._sliders[label].items()}
            loaded = self._loaded[label]
            try:
                design = changed(loaded, parameters_of(loaded), factors)
                self._views[label].show(design)
            except HyperlegError as error:
                self._message.content = f"**This makes no robot:** {error}"
                self._message.visible = True
                self._views[label].show(self.designs[label])
                return
            self._message.visible = False
            self.designs[label] = design
            self._refresh()

    def show_time(self, seconds: float) -> None:
        """Show the walk at a time.

        Args:
            seconds: from its start [s].
        """
        walk = self._walk
        if walk is None:
            return
        with self._lock:
            row = walk.row(seconds)
            for label, view in self._views.items():
                weight = float(total_mass(self.designs[label])) * GRAVITY
                view.play(walk, row, weight, self._scale)
            base = walk.base(row)
            if base is not None:
                cell = np.floor(base[1][:2])
                self._grid.position = (*(cell - base[1][:2]), 0.0)
            forces = [force for _, force in next(iter(self._views.values())).contacts]
            total = np.sum(forces, axis=0) if forces else np.zeros(3)
            weight = float(total_mass(walk.design)) * GRAVITY
            self._forces.content = (
                f"Ground: {total[2]:.0f} N up, {np.hypot(*total[:2]):.0f} N along the floor "
                f"({total[2] / weight:.2f} body weights)"
            )

    def _work(self) -> None:
        """Rebuild robots whose sliders moved, and step the walk; ends with the page.

        Sliders send every place that they pass; rebuilding here takes the last one only.
        """
        charted = 0.0
        while not self._stop.wait(1 / FRAME_RATE):
            for label in [label for label in self._moved if self._moved[label].is_set()]:
                self._moved[label].clear()
                self.rebuild(label)
            if self._walk is None or not self._playing.value:
                continue
            after = self._time.value + self._speed.value / FRAME_RATE
            self._time.value = 0.0 if after > self._walk.duration else after
            self.show_time(self._time.value)
            if time.monotonic() - charted > CHART_TIME:
                charted = time.monotonic()
                self._refresh_motor()

    def _restyle(self) -> None:
        self.server.gui.configure_theme(
            dark_mode=self._dark.value,
            show_logo=False,
            show_share_button=False,
            brand_color=(200, 96, 42),
        )
        cell, section = ((45, 48, 54), (75, 80, 90)) if self._dark.value else (_CELL, _SECTION)
        self._grid.cell_color, self._grid.section_color = cell, section
        self._refresh()

    def _refresh(self) -> None:
        self._masses.content = masses_text(self.designs)
        self._refresh_motor()
        self._refresh_slices()

    def _refresh_motor(self) -> None:
        self._motor_chart.figure = self._motor_figure()

    def _refresh_slices(self) -> None:
        self._slice_chart.figure = self._slice_figure()

    def _motor_figure(self) -> Any:
        row = None if self._walk is None else self._walk.row(self._time.value)
        return charts.motor_chart(
            self.designs, self._motor.value, self._walk, row, dark=self._dark.value
        )

    def _slice_figure(self) -> Any:
        return charts.slice_chart(
            self.designs, self._pairs[self._pair.value], dark=self._dark.value
        )


def _height(design: RobotDesign) -> float:
    """About how tall a robot stands [m]."""
    tree = build_tree(design)
    poses = link_poses(tree, default_angles(tree))
    top = max(
        float(poses[link.name][1][2]) + max((s.position[2] for s in link.visuals), default=0.0)
        for link in tree.links
    )
    return max(top - lowest_point(tree, poses), 0.2) * 1.15
