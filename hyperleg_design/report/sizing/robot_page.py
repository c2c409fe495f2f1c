"""The page of one robot of any family: what it looks like, what its joints can do, its motors and
parameters.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design import provenance
from hyperleg_design.report import text, tree_text
from hyperleg_design.report.drawer import FIGURES, Drawer
from hyperleg_design.report.page import Details, Page, Section, Table, render
from hyperleg_design.report.pictures import picture, scenes
from hyperleg_design.sizing.analysis import analyze
from hyperleg_design.writing import output_folder, write_json, write_text

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign

LEAD = "Masses, torques, speeds and motors as they follow from the parameters at the end."


def write_robot_page(
    design: RobotDesign, out: str | os.PathLike[str], analysis: Mapping[str, Any] | None = None
) -> Path:
    """Write the page of a robot, and its analysis as JSON.

    Args:
        design: one robot, of any family.
        out: folder to write; a folder of ours is replaced.
        analysis: as `analyze` returns it, if it is already there.

    Returns:
        The page, `out/index.html`.

    Raises:
        InputError: a batch of designs.
        OutputError: the folder is not ours, or cannot be written.
    """
    analysis = analysis or analyze(design)
    whole = "family" in analysis
    words: Any = tree_text if whole else text
    masses = analysis["link_mass" if whole else "segment_mass"]
    with output_folder(out) as folder:
        (folder / FIGURES).mkdir()
        drawn = Drawer(folder)(
            "robot",
            "The robot in its default posture; motors are drawn where the design houses them.",
            lambda path: picture.render(scenes.robot_scene(design), path),
            chart=False,
        )
        note = tree_text.JOINTS_NOTE if whole else text.joints_note(analysis)
        heads, rows = words.joint_table(analysis)
        joints: list[Any] = [Table(heads, rows, note)]
        if whole:
            joints += tree_text.force_lines(analysis)
        sections = [
            Section("The robot", [drawn]),
            Section("What the joints can do", joints),
            Section("Motors and gears", [Table(*words.motor_table(analysis))]),
            Section("Masses", [Table(["link", "mass [kg]"], list(masses.items()))]),
            Section("Parameters", parameters_content(design)),
        ]
        page = Page(
            title=design.name,
            lead=LEAD,
            sections=sections,
            facts=_facts(analysis),
            provenance={
                **provenance.versions(),
                "commit": provenance.git_commit() or "unknown",
                "made by": "hyperleg analyze",
            },
        )
        write_json(folder / "analysis.json", dict(analysis))
        write_text(folder / "index.html", render(page))
    return Path(out) / "index.html"


def _facts(analysis: Mapping[str, Any]) -> list[tuple[str, str]]:
    facts = [(f"{analysis['total_mass']:.2f} kg", "total mass")]
    if "leg_mass" in analysis:
        facts.append((f"{analysis['leg_mass']:.2f} kg", "one leg"))
        facts.append((f"{analysis['height']:.3f} m", "height"))
    else:
        limb = "one limb" if analysis["limbs"] else "all but the trunk"
        facts.append((f"{analysis['limb_mass']:.2f} kg", limb))
        if analysis["standing_height"] is not None:
            facts.append((f"{analysis['standing_height']:.3f} m", "standing height of the trunk"))
    share = 100 * analysis["zonotope_to_box_volume"]
    facts.append((f"{share:.1f} %", "of the box of maximum torques can be reached"))
    return facts


def parameters_content(design: RobotDesign) -> list[Any]:
    """List all parameters of a design with their labels and sources.

    Args:
        design: one robot, of any family.

    Returns:
        A sentence that counts them, and the folded table.
    """
    labels: dict[str, int] = {}
    rows = []
    for path, rule in design.rules.items():
        origin = design.origins.get(path)
        label = origin.label if origin else ""
        labels[label] = labels.get(label, 0) + 1
        value = design[path]
        shown = ", ".join(f"{v:g}" for v in value) if isinstance(value, np.ndarray) else value
        rows.append([path, shown, rule.unit, label, origin.source if origin else ""])
    summary = ", ".join(f"{count} {label}" for label, count in sorted(labels.items()))
    return [
        f"The design has {len(rows)} parameters: {summary}. Any of them can be set from the "
        "command line, in a file, or in Python, and can be an axis of a sweep.",
        Details("All parameters", [Table(["parameter", "value", "unit", "label", "source"], rows)]),
    ]
