"""A robot as files that other programs load: URDF, MJCF, resolved design, xacro with its numbers,
mass table.
"""

from __future__ import annotations

import csv
import hashlib
import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from hyperleg_design import provenance, resources
from hyperleg_design.reading import short_name
from hyperleg_design.robot.description import TEMPLATE, tree_yaml, urdf
from hyperleg_design.robot.kinematics import dimensions
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.mass.mass_rows import MassRow, mass_rows
from hyperleg_design.robot.mjcf import mjcf
from hyperleg_design.robot.own_motors import motors_beside
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.writing import output_folder, write_bytes, write_json

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign

COLUMNS = (
    "kind",
    "name",
    "count",
    "mass_kg",
    "com_x_m",
    "com_y_m",
    "com_z_m",
    "principal_inertia_1_kg_m2",
    "principal_inertia_2_kg_m2",
    "principal_inertia_3_kg_m2",
)


def build(design: RobotDesign, out: str | Path) -> Path:
    """Write a folder with everything about one robot; the same design gives the same bytes.

    `NAME.urdf` and `NAME.xml` (MJCF), `design.yaml` (reads back as the same design, with copies of
    motors that are not shipped in `own_motors/`), `tree.yaml` with the xacro template (`xacro
    robot.urdf.xacro tree:=tree.yaml`), `masses.csv`, `masses.md`, and `manifest.json` with versions
    and checksums.

    Args:
        design: one robot.
        out: folder to write: new, empty, or one that this package made, which is replaced as a
            whole.

    Returns:
        The folder.

    Raises:
        InputError: a batch of designs, or two motors of the same name.
        OutputError: the folder is not ours, or cannot be written; nothing is left half-written.
    """
    tree = build_tree(design)
    rows = mass_rows(design)
    mapping = design.to_mapping()
    motors = motors_beside(mapping)
    texts = {
        f"{design.name}.urdf": urdf(design, tree),
        f"{design.name}.xml": mjcf(design),
        "design.yaml": _design_yaml(mapping),
        "tree.yaml": tree_yaml(tree),
        "masses.csv": masses_csv(rows),
        "masses.md": masses_markdown(design, rows),
    }
    files = {name: text.encode() for name, text in texts.items()} | motors
    template = (resources.content_folder("descriptions") / TEMPLATE).read_text(encoding="utf-8")
    files[TEMPLATE] = template.replace(
        '<robot name="robot"', f'<robot name="{design.name}"'
    ).encode()
    with output_folder(out) as folder:
        for name, content in files.items():
            write_bytes(folder / name, content)
        write_json(folder / "manifest.json", _manifest(design, files))
    return Path(out)


def design_yaml(design: RobotDesign) -> str:
    """Write the resolved design as YAML, with label and source of each value.

    Args:
        design: one robot.

    Returns:
        The text; `load_design` reads it back as the same design.
    """
    return _design_yaml(design.to_mapping())


def _design_yaml(mapping: dict[str, Any]) -> str:
    head = (
        "# A resolved design: every value, with label and source. `hyperleg build --design "
        "design.yaml` makes the same robot.\n"
    )
    return head + yaml.dump(
        mapping,
        Dumper=getattr(yaml, "CSafeDumper", yaml.SafeDumper),
        sort_keys=False,
        default_flow_style=None,
        allow_unicode=True,
        width=200,
    )


def masses_csv(rows: list[MassRow]) -> str:
    """Write the mass table as CSV, in SI units, to 12 digits: further ones of eigenvalues depend on
    the processor.

    Args:
        rows: of the table.

    Returns:
        The text, with a line of headings.
    """
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in rows:
        writer.writerow(
            [
                row.kind,
                row.name,
                row.count,
                *(f"{value:.12g}" for value in (row.mass, *row.com, *row.principal)),
            ]
        )
    return stream.getvalue()


def masses_markdown(design: RobotDesign, rows: list[MassRow]) -> str:
    """Write the mass table for people, in kilograms, millimetres and gram square metres.

    Args:
        design: names the robot in the text.
        rows: of the table.

    Returns:
        A Markdown text.
    """
    cells = [
        ["part", "pieces", "mass [kg]", "centre of mass x, y, z [mm]", "principal inertia [g m²]"]
    ]
    for row in rows:
        com = ", ".join(f"{round(1e3 * v, 1) + 0.0:.1f}" for v in row.com)
        principal = ", ".join(f"{1e3 * v:.4g}" for v in row.principal)
        cells.append(
            [
                f"{row.kind} {row.name}" if row.kind in ("link", "segment") else row.name,
                str(row.count),
                f"{row.mass:.3f}",
                com,
                principal,
            ]
        )
    widths = [max(len(line[i]) for line in cells) for i in range(len(cells[0]))]
    lines = [
        f"| {' | '.join(cell.ljust(width) for cell, width in zip(line, widths, strict=True))} |"
        for line in cells
    ]
    lines.insert(1, f"|{'|'.join('-' * (width + 2) for width in widths)}|")
    if isinstance(design, TreeDesign):
        note = (
            "Parts of one limb as described. Centres of mass of links are measured from their "
            "joint, of limb and robot\nfrom the root link, in the zero posture."
        )
        return f"# Masses of {design.name}\n\n{note}\n\n" + "\n".join(lines) + "\n"
    note = (
        "Left parts; the right ones mirror y. Centres of mass of links and segments are measured "
        "from their upper joint, of leg and robot\n"
        "from the midpoint of the hips, in the zero posture: x forward, y left, z up."
    )
    return f"# Masses of {design.name} ({design.variant})\n\n{note}\n\n" + "\n".join(lines) + "\n"


def _manifest(design: RobotDesign, files: dict[str, bytes]) -> dict[str, Any]:
    return {
        "design": design.name,
        "variant": design.variant,
        "source": short_name(Path(design.source)) if design.source else "",
        "total_mass": float(dimensions.total_mass(design)),
        "leg_mass": float(dimensions.limb_mass(design)),
        "versions": provenance.versions(),
        "git_commit": provenance.git_commit() or None,
        "sha256": {
            name: hashlib.sha256(content).hexdigest() for name, content in sorted(files.items())
        },
    }


__all__ = ["build", "design_yaml", "mass_rows", "masses_csv", "masses_markdown"]
