from __future__ import annotations

from hyperleg_design.sizing.other_robots import robots_folder
from hyperleg_design.sizing.robot_sources import SOURCES


def test_every_source_is_a_file_and_a_name_of_its_own():
    folder = robots_folder()
    assert len({s.name for s in SOURCES}) == len(SOURCES) >= 8
    for source in SOURCES:
        assert (folder / source.file).is_file(), source.name
        assert source.kind in ("biped", "quadruped", "human")
        assert source.legs in (2, 4)


def test_every_source_names_joints_that_its_file_holds():
    for source in SOURCES:
        text = (robots_folder() / source.file).read_text()
        for name in (source.first_hip, source.hip_pitch, source.knee, source.foot):
            assert f'"{name}"' in text or f"'{name}'" in text, (source.name, name)
