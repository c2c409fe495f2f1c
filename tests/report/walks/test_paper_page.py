"""One command from a folder of policies to the page."""

from __future__ import annotations

import pytest

from hyperleg_design.cli import main
from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.evaluation.protocol import Steady, TTestProtocol, WalkProtocol
from hyperleg_design.report.pictures import gif
from hyperleg_design.report.walks import paper_page
from hyperleg_design.writing import write_bytes


@pytest.fixture(scope="module")
def page(trainings, tmp_path_factory):
    short = WalkProtocol(trials=2, distance=2.0, time_limit=1.6, steady=Steady(begin=0.5))
    out = tmp_path_factory.mktemp("paper") / "out"
    with pytest.MonkeyPatch.context() as patch:  # animations are drawn in test_gif
        patch.setattr(gif, "render_gif", lambda made, path: write_bytes(path, b"GIF89a"))
        return paper_page.run_paper(
            trainings,
            out,
            walk=short,
            t_test=TTestProtocol(trials=2, time_limit=15.0),
            band=(0.02,),
            workers=1,
            progress=False,
        )


def test_policies_that_only_fall_give_a_page_that_says_so(page):
    html = page.read_text()
    for word in (
        "4 policies of 4 trainings",
        "nothing was measured",
        "cannot be reproduced",
        "too few strides",
        "gait clock",
    ):
        assert word in html, word
    tables = paper_page.read_tables(page.parent)
    assert list(tables) == ["Table III, walk_upright"]
    time = next(
        row for row in tables["Table III, walk_upright"] if row["quantity"] == "time to goal"
    )
    assert time["toe"]["verdict"] == time["change"]["verdict"] == "cannot be reproduced"
    assert time["toe"]["missing"] == 4
    assert (page.parent / "evaluation" / "trials.parquet").exists()


def test_the_tables_read_in_a_terminal(page):
    text = paper_page.tables_text(paper_page.read_tables(page.parent))
    assert text.startswith("Table III, walk")
    assert "cannot be reproduced" in text
    assert "-16.9 %" in text


def test_a_folder_without_trainings_is_refused_and_nothing_written(tmp_path, capsys):
    (tmp_path / "none").mkdir()
    arguments = ["--policies", str(tmp_path / "none"), "--out", str(tmp_path / "out")]
    assert main(["paper", *arguments]) == 2
    assert "none'" in (error := capsys.readouterr().err)
    assert "holds no finished training" in error
    assert not (tmp_path / "out").exists()


def test_bad_folders_stop_before_any_work(tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        paper_page.run_paper(tmp_path / "nothing", tmp_path / "out")
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("mine")
    with pytest.raises(OutputError):
        paper_page.run_paper(tmp_path, tmp_path / "mine")
    assert not (tmp_path / "out").exists()
