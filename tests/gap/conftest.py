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


@pytest.fixture(scope="session")
def viscous_ready(robot_files):
    """What causes are fitted on, of two logs of a coupled rig with viscous friction at its knee."""
    import diagnosed

    return diagnosed.prepared(
        robot_files["coupled"], diagnosed.run("viscous", 0), diagnosed.run("viscous", 1)
    )


@pytest.fixture(scope="session")
def knee_friction(viscous_ready):
    """The true cause of these logs."""
    import numpy as np

    from hyperleg_design.gap.effects import EFFECTS
    from hyperleg_design.gap.inference.screen import linearise

    return linearise(viscous_ready.base.samples, EFFECTS["viscous_friction"], "knee", np.zeros(1))


@pytest.fixture(scope="session")
def judged(robot_files):
    """Judge and decision on a coupled rig whose knee has viscous friction."""
    import diagnosed

    from hyperleg_design.gap.inference.decide import decide
    from hyperleg_design.gap.inference.screen import places
    from hyperleg_design.gap.inference.thresholds import load_thresholds

    ready = diagnosed.prepared(
        robot_files["coupled"], *(diagnosed.run("viscous", s, session="a") for s in (0, 1))
    )
    subject = ready.base.samples.filtered_logs[0].signals.subject
    friction = ("viscous_friction", "coulomb_friction", "stribeck_friction", "torque_constant")
    return decide(ready.base, load_thresholds(), places(subject, friction))


@pytest.fixture(scope="session")
def two_wrong(robot_files):
    """Judge of a coupled rig whose knee has viscous friction and whose hip rubs."""
    import diagnosed

    from hyperleg_design.gap.inference.judge import Judge
    from hyperleg_design.gap.inference.thresholds import load_thresholds

    ready = diagnosed.prepared(
        robot_files["coupled"], *(diagnosed.run("both", s, session="a") for s in (0, 1))
    )
    return Judge(ready.base, load_thresholds(), 1)
