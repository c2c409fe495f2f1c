"""The page of a sweep holds its designs, and works in a real browser."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.report.sweep import explorer
from hyperleg_design.report.sweep.page import sweep_report
from hyperleg_design.report.sweep.rows import base_level, thinned
from hyperleg_design.robot.load import load_robot
from hyperleg_design.sweep.run import run_sweep
from hyperleg_design.sweep.space import sweep_from_mapping
from tests.browser import Browser, executable

DEFINITION = {
    "name": "explored",
    "design": "hyperleg",
    "description": "small",
    "variants": ["toe", "toe_removed_matched"],
    "axes": {
        "toe.mass": {"low": 0.1, "high": 0.5, "steps": 5},
        "legs": {"paths": ["thigh.length"], "scale": {"low": 0.8, "high": 1.2, "steps": 3}},
        "actuators.knee.motor": {"values": ["RI60", "RI70"]},
    },
    "objectives": ["swing_inertia", "squat_heat"],
    "maps": [
        {"x": "toe.mass", "y": "legs", "measure": "squat_heat"},
        {"x": "toe.mass", "measure": "total_mass"},
    ],
}


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    out = tmp_path_factory.mktemp("explored") / "out"
    return run_sweep(sweep_from_mapping(DEFINITION), out, progress=False)


@pytest.fixture(scope="module")
def page(result):
    sweep_report(result)
    return result.folder / "index.html"


@pytest.fixture(scope="module")
def browser():
    if (program := executable()) is None:
        pytest.skip("no Chromium: apt-get install chromium")
    running = Browser(program)
    yield running
    running.close()


def of_heat(result, monkeypatch=None, most=None):
    sweep = result.sweep
    columns = ["variant", *(axis.name for axis in sweep.axes), "squat_heat"]
    table = result.columns(columns)
    front = np.zeros(len(table["variant"]), bool)
    front[3] = True
    if most:
        monkeypatch.setattr(explorer, "MOST_POINTS", most)
    item = explorer.explorer(sweep, table, {"squat_heat": "heat"}, sweep.maps[:1], front, "a")
    return table, {c["name"]: c for c in item.data["columns"]}, item.data


def test_every_design_of_a_small_sweep_is_there(result):
    table, columns, data = of_heat(result)
    assert columns["variant"]["values"] == [str(v) for v in table["variant"]]
    finite = np.isfinite(table["squat_heat"])
    shown = np.array(columns["squat_heat"]["values"], float)
    np.testing.assert_allclose(shown[finite], table["squat_heat"][finite], rtol=1e-4)
    assert np.flatnonzero(data["front"]).tolist() == [3]
    assert data["shown"] == f"{len(table['variant'])} designs"


def test_of_a_large_sweep_fronts_and_maps_stay(result, monkeypatch):
    _, columns, data = of_heat(result, monkeypatch, most=12)
    assert sum(data["front"]) == 1
    motors = columns["actuators.knee.motor"]
    assert motors["values"].count(motors["base"]) >= 30  # the map, over both variants
    assert data["shown"].endswith("designs, a sample of 60")


def test_designs_that_differ_in_mass_only_share_a_drawing(result):
    _, columns, data = of_heat(result)
    assert len(data["drawings"]) == 2 * 3  # variants and lengths
    parts = (columns["legs"]["values"], columns["variant"]["values"], data["robot"])
    assert len(set(zip(*parts, strict=True))) == 6


def test_a_side_view_stands_on_the_floor_and_is_as_tall_as_the_robot():
    for name in ("toe", "mini_cheetah"):
        view = np.array(explorer.side_view(load_robot(name)))
        heights = view[:, [1, 3]]
        assert 0 <= heights.min() <= 30
        assert 250 < heights.max() < 1100


def test_the_command_of_a_file_names_the_file_and_no_variant(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.yaml").write_text("base: mini_cheetah\nname: other\n")
    axes = {"links.trunk.mass": {"values": [3.0, 4.0]}}
    sweep = sweep_from_mapping({"design": "mine.yaml", "axes": axes, "measures": ["total_mass"]})
    table = {"variant": np.array(["as_described"] * 2), "links.trunk.mass": np.array([3.0, 4.0])}
    data = explorer.explorer(sweep, table, {}, (), np.zeros(2, bool), "a").data
    assert data["look"][1] == "hyperleg view mine.yaml --set 'links.trunk.mass=4'"
    assert data["columns"][0]["label"] == "none"


def test_thinning_spreads_and_levels_are_nearest(result):
    assert thinned(5, 9).tolist() == [0, 1, 2, 3, 4]
    assert thinned(101, 3).tolist() == [0, 50, 100]
    levels = {axis.name: base_level(axis, result.sweep) for axis in result.sweep.axes}
    assert levels == {"toe.mass": 0.2, "legs": 1.0, "actuators.knee.motor": "RI70"}


def test_a_reader_sorts_filters_and_selects(page, browser):
    browser.open(page.as_uri())
    assert browser.run("document.querySelectorAll('.plot .point').length") > 0
    rows = "[...document.querySelectorAll('.explorer .scroll tbody tr')]"
    cells = f"{rows}.map(r => +r.cells[1].innerText)"
    heading = "document.querySelectorAll('.explorer thead button')[1].click()"
    browser.run(heading)
    rising = browser.run(cells)
    assert rising == sorted(rising)
    assert len(set(rising)) == 5
    browser.run(heading)
    assert browser.run(cells) == rising[::-1]
    browser.run(
        "(() => { const e = document.querySelector('.explorer'); "
        "e.querySelector('.filter').value = 'toe.mass'; "
        "const low = e.querySelector('.low'); low.value = 0.35; low.oninput(); })()"
    )
    assert min(browser.run(cells)) >= 0.4
    browser.run("document.querySelector('.explorer .scroll tbody tr').click()")
    assert browser.run("document.querySelectorAll('svg.robot line').length") >= 8
    look = browser.run("document.querySelector('.look').innerText")
    assert look.startswith("hyperleg view hyperleg --variant toe")
    assert "--set 'toe.mass=0.5'" in look
    assert browser.errors == []


def rows_after(browser, **values):
    """Rows of the table after controls of the explorer are set."""
    for name, value in values.items():
        browser.run(
            f"(() => {{ const c = document.querySelector('.explorer .{name}'); "
            f"c.value = {value!r}; c.oninput(); }})()"
        )
    text = "[...document.querySelectorAll('.explorer .scroll tbody tr')].map(r => r.innerText)"
    return [row.split("\t") for row in browser.run(text)]


def test_a_map_shows_one_variant_and_a_cloud_of_measures_all_designs(page, browser):
    browser.open(page.as_uri())
    assert {row[0] for row in rows_after(browser)} == {"toe"}
    count = browser.run("document.querySelector('.explorer .count').innerText")
    assert count == "15 of 60 designs; in the others, further parameters are changed"
    assert len(rows_after(browser)) == 5 * 3
    assert {row[0] for row in rows_after(browser, variant="")} == {"toe", "toe_removed_matched"}
    rows_after(browser, x="swing_inertia", y="squat_heat", colour="variant")
    count = browser.run("document.querySelector('.explorer .count').innerText")
    assert count.startswith("60 of 60 designs")
    rows_after(browser, x="actuators.knee.motor", y="toe.mass")
    kind = "document.querySelector('.plot')._fullLayout.xaxis.type"
    assert browser.run(kind) == "category"
    assert browser.errors == []


def test_a_page_asks_no_server_for_anything(page, browser):
    browser.open(page.as_uri())
    loaded = browser.run("performance.getEntriesByType('resource').map(e => e.name)")
    assert [name for name in loaded if name.startswith("http")] == []
    assert page.stat().st_size < 6e6
    assert browser.errors == []


def test_a_click_on_a_point_shows_its_robot(page, browser):
    browser.open(page.as_uri())
    place = browser.run(
        "(() => { const p = document.querySelector('.plot .point'); p.scrollIntoView({block: "
        "'center'}); const b = p.getBoundingClientRect(); "
        "return [b.x + b.width / 2, b.y + b.height / 2] })()"
    )
    mouse = {"x": place[0], "y": place[1], "button": "left", "clickCount": 1}
    for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
        browser.call("Input.dispatchMouseEvent", type=kind, **mouse)
    browser.wait("!document.querySelector('.detail').hidden", seconds=20)
    assert browser.run("document.querySelector('.hoverlayer').innerHTML.includes('toe.mass')")
    assert browser.errors == []


@pytest.mark.parametrize("dark", [False, True])
def test_a_phone_scrolls_down_only_and_the_dark_scheme_is_dark(page, browser, dark):
    browser.open(page.as_uri(), width=390, height=844, dark=dark)
    browser.run("document.querySelector('.explorer .scroll tbody tr').click()")
    assert browser.run("document.querySelectorAll('.explorer .values tr').length") == 7
    assert browser.run("document.documentElement.scrollWidth") <= 390
    colour = browser.run("getComputedStyle(document.body).backgroundColor")
    brightness = sum(int(v) for v in colour[4:-1].split(",")) / 3
    assert (brightness < 60) == dark
    ink = browser.run("document.querySelector('.plot .xtitle').style.fill")
    assert (sum(int(v) for v in ink[4:-1].split(",")) / 3 > 200) == dark
    assert browser.errors == []
