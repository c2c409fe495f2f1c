"""An experiment that is designed for a pendulum, with its files."""

from types import SimpleNamespace

import pytest

from hyperleg_design.gap.experiments.excite import excite


@pytest.fixture(scope="module")
def made(robot_files, tmp_path_factory):
    import robots

    folder = tmp_path_factory.mktemp("plan")
    path = folder / "servo.xml"
    servo = '<position name="servo" joint="swing" kp="12" kv="0.4" forcerange="-3 3"/>'
    path.write_text(
        robots.PENDULUM.replace(
            '<motor name="servo" joint="swing" ctrlrange="-3 3"/>', servo
        ).replace('axis="0 1 0"', 'axis="0 1 0" range="-80 80"')
    )
    out = folder / "out"
    out.mkdir()
    return SimpleNamespace(path=path, out=out, plan=excite(path, out, rate=100.0, kinds="both"))
