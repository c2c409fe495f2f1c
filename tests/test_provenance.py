from __future__ import annotations

import subprocess

from hyperleg_design import provenance


def test_versions_say_what_is_missing():
    found = provenance.versions(("numpy", "no-such-package"))
    assert found["numpy"][0].isdigit()
    assert found["no-such-package"] == "missing"


def test_commit_is_empty_outside_a_checkout(tmp_path):
    assert provenance.git_commit(tmp_path) == ""


def test_commit_is_that_of_the_checkout_and_says_when_it_was_changed(tmp_path):
    def git(*arguments: str) -> str:
        identity = ["-c", "user.name=a", "-c", "user.email=a@b"]
        return subprocess.run(
            ["git", "-C", str(tmp_path), *identity, *arguments],
            capture_output=True,
            text=True,
            check=True,
        ).stdout.strip()

    git("init", "-q")
    (tmp_path / "a").write_text("1")
    git("add", "a")
    git("commit", "-qm", "one")
    head = git("rev-parse", "--short=12", "HEAD")
    assert provenance.git_commit.__wrapped__(tmp_path) == head
    (tmp_path / "a").write_text("2")
    assert provenance.git_commit.__wrapped__(tmp_path) == f"{head}-dirty"
