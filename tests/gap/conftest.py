import os
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def real_logs() -> Path:
    """Folder of real hardware logs, which is not part of the repository."""
    folder = Path(
        os.environ.get("HYPERLEG_DATA")
        or Path(__file__).resolve().parents[2].parent / "shared" / "data"
    )
    if not folder.is_dir():
        pytest.skip(f"no real logs in {folder}; set HYPERLEG_DATA to their folder")
    return folder


@pytest.fixture(scope="session")
def robot_files(tmp_path_factory) -> dict[str, Path]:
    """MJCF files of other people's robots, by name."""
    import robots

    folder = tmp_path_factory.mktemp("robots")
    found = {}
    for name in ("pendulum", "arm", "coupled", "geared", "servos"):
        found[name] = folder / f"{name}.xml"
        found[name].write_text(getattr(robots, name.upper()))
    return found


@pytest.fixture(scope="session")
def runs():
    """Logs of ten seconds of each of those robots at 200 Hz, without noise."""
    import robots

    targets = {
        "pendulum": robots.waves(1, 0.4),
        "arm": robots.waves(6, 0.6, 0.1, 1.0),
        "coupled": robots.waves(2, [1.0, 1.0]),
    }
    return {
        name: robots.servo_run(getattr(robots, name.upper()), target, 10.0)
        for name, target in targets.items()
    }


@pytest.fixture(scope="session")
def biped_runs():
    """Our biped, standing and thrown up."""
    import robots

    return {"standing": robots.biped_run(), "thrown": robots.biped_run(height=4.0)}
