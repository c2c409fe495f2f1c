"""HyperLeg's files stay the same byte for byte, whatever else is described beside it.

The hashes in `unchanged_files.json` were taken before the kinematic tree became data. A change that
is meant to alter the files is followed by `python -m tests.robot.test_unchanged_files`, which
writes them anew.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import pytest

from hyperleg_design.robot.build import masses_csv, masses_markdown
from hyperleg_design.robot.description import tree_yaml, urdf
from hyperleg_design.robot.design import Design, load_design
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.mass.mass_rows import mass_rows
from hyperleg_design.robot.mjcf import mjcf
from hyperleg_design.robot.names import VARIANTS
from hyperleg_design.sizing.analysis import analyze

HASHES = Path(__file__).with_name("unchanged_files.json")

OVERRIDES = (
    "toe.mass=0.3",
    "thigh.length=0.40",
    "shank.length=0.30 thigh.length=0.35",
    "actuators.knee.motor=RI80",
    "actuators.knee.gear=9",
    "actuators.ankle.motor=RI70 actuators.ankle.gear=6",
    "actuators.toe.motor=RI50",
    "actuators.hip_pitch.motor=U8",
    "actuators.hip_yaw.gear=20",
    "transmission.posture=standing",
    "transmission.scale.knee=1.2",
    "transmission.scale.toe=0.8",
    "actuators.knee.housed_in=shank",
    "actuators.ankle.position_fraction=0.2",
    "masses.law=fixed",
    "masses.thigh_ballast=0.4",
    "pelvis.mass=20",
    "foot.width=0.1 contact.friction=0.8",
    "joints.knee.coulomb=2 joints.toe.viscous=0.2",
    "joints.knee.default_deg=20 joints.hip_pitch.default_deg=-10",
    "electrical.voltage_ratio=0.8 electrical.constants=vendor",
    "contact.pad_radius=0.01 hip.spacing=0.22",
    "masses.gear_mass_per_torque=0.008",
)


def hashes(design: Design) -> dict[str, str]:
    """First digits of the SHA-256 of each file of one robot, and of its analysis to 10 digits."""
    tree, rows = build_tree(design), mass_rows(design)
    texts = {
        "urdf": urdf(design, tree),
        "mjcf": mjcf(design),
        "tree.yaml": tree_yaml(tree),
        "masses.csv": masses_csv(rows),
        "masses.md": masses_markdown(design, rows),
        "analysis": json.dumps(_rounded(analyze(design))),
    }
    return {name: hashlib.sha256(text.encode()).hexdigest()[:16] for name, text in texts.items()}


def _rounded(value: object) -> object:
    if isinstance(value, dict):
        return {key: _rounded(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_rounded(part) for part in value]
    return f"{value:.10g}" if isinstance(value, float) else value


def cases() -> dict[str, Design]:
    """HyperLeg, its ablations, and HyperLeg with values replaced, by name."""
    found = {name: load_design(name) for name in VARIANTS}
    return found | {text: load_design(overrides=text.split()) for text in OVERRIDES}


@pytest.mark.parametrize("name", VARIANTS)
def test_files_of_hyperleg_and_its_ablations_are_unchanged(name: str) -> None:
    assert hashes(load_design(name)) == json.loads(HASHES.read_text())[name]


@pytest.mark.slow
@pytest.mark.parametrize("overrides", OVERRIDES)
def test_files_with_values_replaced_are_unchanged(overrides: str) -> None:
    design = load_design(overrides=overrides.split())
    assert hashes(design) == json.loads(HASHES.read_text())[overrides]


if __name__ == "__main__":
    written = {name: hashes(design) for name, design in cases().items()}
    HASHES.write_text(json.dumps(written, indent=1) + "\n")
