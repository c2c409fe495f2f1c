"""What a viewer needs before it starts: its packages, and a port to listen on."""

from __future__ import annotations

import importlib.util
import socket

from hyperleg_design.errors import InputError

LAST_PORT = 65535
"""Largest number of a port of TCP."""


def check_installed() -> None:
    """Whether the packages of the extra `view` are there.

    Raises:
        InputError: one is missing.
    """
    missing = [name for name in ("viser", "plotly") if importlib.util.find_spec(name) is None]
    if missing:
        raise InputError(
            "view", "", None, f"needs {' and '.join(missing)}: pip install 'hyperleg-design[view]'"
        )


def check_port(host: str, port: int) -> None:
    """Check that a server can listen on a port.

    Args:
        host: address.
        port: number of the port.

    Raises:
        InputError: the port is taken or not allowed, or the host is not this machine's.
    """
    if not 1 <= port <= LAST_PORT:
        raise InputError("view", "--port", port, f"expects a number within 1 .. {LAST_PORT}")
    try:
        family, kind, *_, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        with socket.socket(family, kind) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
    except socket.gaierror:
        raise InputError("view", "--host", host, "is no address of this machine") from None
    except OSError as error:
        raise InputError(
            "view",
            "--port",
            port,
            f"cannot be listened on ({(error.strerror or str(error)).lower()}); choose another "
            "with --port",
        ) from None
