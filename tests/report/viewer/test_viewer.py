"""The page serves, rebuilds robots, plays walks, and tells what is wrong."""

from __future__ import annotations

import socket

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.recording import log_of_trial
from hyperleg_design.report.viewer import needs, viewer
from hyperleg_design.report.viewer.walk import RecordedWalk
from hyperleg_design.robot.load import load_robot
from tests.browser import Browser, executable

viser = pytest.importorskip("viser")


def free_port():
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


@pytest.fixture(scope="module")
def page(walks):
    trial = walks["toe"]
    shown = viewer.Viewer(
        {"toe": trial.design, "cheetah": load_robot("mini_cheetah")},
        RecordedWalk(log_of_trial(trial), trial.design),
        port=free_port(),
    )
    yield shown
    shown.close()


def test_sliders_rebuild_the_robot_and_its_masses(page):
    page.set_slider("toe", "toe.mass", 2.0)
    assert page.designs["toe"].toe.mass == pytest.approx(0.44)
    assert "| toe | 0.440 |" in page._masses.content
    page.set_slider("toe", "thigh.mass", 0.1)
    assert page._message.visible
    assert "makes no robot" in page._message.content
    assert page.designs["toe"].toe.mass == pytest.approx(0.44)
    page.set_slider("toe", "thigh.mass", 1.0)
    page.set_slider("toe", "toe.mass", 1.0)
    assert not page._message.visible
    with pytest.raises(InputError, match="expects one of"):
        page.set_slider("toe", "nose.mass", 2.0)


def test_a_time_puts_the_links_where_the_walk_had_them(page, walks):
    page._playing.value = False
    page.show_time(1.0)
    row = round(1.0 / walks["toe"].time_step)
    root = page._views["toe"]._root
    assert root.position[2] == pytest.approx(walks["toe"].base_position[row, 2])
    assert root.position[0] == 0.0
    force = walks["toe"].pad_force[row].sum(0)
    told = sum(force for _, force in page._views["toe"].contacts)
    assert told == pytest.approx(force, abs=2.0)
    assert f"Ground: {told[2]:.0f} N up" in page._forces.content
    assert np.isfinite(page._motor_figure().data[-1].x).all()


def test_a_browser_shows_the_page(page):
    if (program := executable()) is None:
        pytest.skip("no Chromium: apt-get install chromium")
    browser = Browser(program)
    try:
        browser.open(page.url, width=390, height=800)
        browser.wait("document.querySelectorAll('[role=tab]').length == 3")
        browser.wait("document.body.innerText.includes('32.000')")
        assert browser.run("document.documentElement.scrollWidth") <= 390
        assert browser.errors == []
    finally:
        browser.close()


def test_a_taken_port_is_told(page):
    port = int(page.url.rsplit(":", 1)[1])
    with pytest.raises(InputError, match="choose another"):
        needs.check_port("localhost", port)
    with pytest.raises(InputError, match="no address"):
        needs.check_port("nowhere.invalid", port)


def test_a_missing_package_is_told(monkeypatch):
    monkeypatch.setattr(needs.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"hyperleg-design\[view\]"):
        needs.check_installed()
