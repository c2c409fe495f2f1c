import os
import sys
from pathlib import Path

import numpy as np
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


@pytest.fixture(scope="module")
def signals(robot_files):
    """A conditioned log of the healthy robot with coupled motors."""
    import diagnosed

    return diagnosed.conditioned(robot_files["coupled"], diagnosed.run("healthy", 0))[0]


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


@pytest.fixture(scope="module")
def standing_biped():
    from hyperleg_design.gap.playback import show

    return show._subject(None, True)


@pytest.fixture(scope="module")
def standing(standing_biped):
    """Signals of a run in which the biped bends its knees and presses its feet apart, with
    alterations of the ground under its left foot.
    """
    from hyperleg_design.gap.effects.ground.ground_friction import ChangedGround
    from hyperleg_design.gap.playback import show, standard_run
    from hyperleg_design.gap.signals.conditioning import condition
    from hyperleg_design.gap.signals.nominal_ground import foot_bodies

    time = np.arange(601) * standard_run.TICK
    target = show._stand_targets(standing_biped, time)
    kept = {}

    def signals(**changes):
        key = tuple(sorted(changes.items()))
        if key not in kept:
            left = foot_bodies(standing_biped, 0)
            alterations = (ChangedGround(left, **changes),) if changes else ()
            log = standard_run.simulated_log(standing_biped, target, time, alterations)[1]
            kept[key] = condition(log, standing_biped)
        return kept[key]

    return signals
