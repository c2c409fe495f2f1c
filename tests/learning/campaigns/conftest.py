from __future__ import annotations

from pathlib import Path

import pytest

from hyperleg_design.learning.campaigns import campaign_status, run_campaign

DATA = {
    "name": "mine",
    "preset": "laptop",
    "groups": [{"name": "walk", "task": "walk", "designs": ["toe", "toe_removed"], "seeds": 2}],
}


@pytest.fixture(autouse=True)
def nothing_shipped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (campaign_status, run_campaign):
        monkeypatch.setattr(module, "shipped_folder", lambda: tmp_path / "policies")
