"""What the viewer needs: packages, and a port that is free."""

from __future__ import annotations

import importlib.util
import socket

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.report.viewer.needs import check_installed, check_port


def test_missing_packages_are_named_with_their_extra(monkeypatch):
    there = importlib.util.find_spec
    lacking = {"viser"}
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name in lacking else there("json")
    )
    with pytest.raises(InputError, match=r"needs viser: pip install 'hyperleg-design\[view\]'"):
        check_installed()
    lacking.clear()
    check_installed()


def test_a_free_port_is_free_again_after_the_check():
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        port = probe.getsockname()[1]
    check_port("localhost", port)
    with socket.socket() as server:  # nothing holds it
        server.bind(("localhost", port))
        server.listen()
        with pytest.raises(InputError, match=rf"--port = {port}: cannot be listened on"):
            check_port("localhost", port)


def test_a_host_of_no_machine_is_refused():
    with pytest.raises(InputError, match=r"--host = 'nowhere\.invalid'"):
        check_port("nowhere.invalid", 8080)
