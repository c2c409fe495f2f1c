"""Trained policies as they are shipped: one folder a training, named `group-design-seed`, such as
`walk_upright-toe-1`.

| file | holds |
|---|---|
| `policy.onnx` | the last policy, weights in half precision (0.15 MB with 256, 128, 64 units) |
| `critic.onnx` | its critic, for trainings that go on from it (older ones have none) |
| `late_*.onnx` | late policies before it, earliest first |
| `run.json` | task, design, preset (all resolved), seed, command, versions, commit |
| `progress.jsonl` | the learning curve, at most `CURVE_ROWS` rows |

A folder of finished trainings (`results/campaign`) has the same form and more files; `pack` keeps
the five above and halves the precision of weights.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import re
import shutil
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hyperleg_design.errors import InputError, meant
from hyperleg_design.evaluation.half_precision import halve_weights
from hyperleg_design.resources import shipped_folder
from hyperleg_design.writing import output_folder, write_bytes, write_text

POLICY, CRITIC, LATE = "policy.onnx", "critic.onnx", "late_*.onnx"
RUN, PROGRESS = "run.json", "progress.jsonl"
CURVE_ROWS = 200
"""Rows of a packed learning curve."""
CURVE = ("steps", "stage", "assist", "reward", "speed", "falls", "cost_of_transport")
"""Numbers of a row of a learning curve; `falls` a minute and robot, `assist` relative."""
GOES_ON = "hyperleg train with the same --out goes on with it"
"""Remedy for a training that is not finished."""
_NAME = re.compile(r"(?P<group>[^.-][^-]*)-(?P<design>.+)-(?P<seed>\d+)")


@dataclass(frozen=True)
class Shipped:
    """One policy of one training."""

    group: str
    """Group of the campaign: `walk`, `t_test` or `walk_paper`."""
    design: str
    """Ablation, by the name of its file."""
    seed: int
    """Seed of the training."""
    late: int
    """0 for the last policy of the training, 1 for the late one before it, and so on."""
    path: Path
    """The ONNX file."""

    @property
    def training(self) -> str:
        """Name of the training's folder."""
        return f"{self.group}-{self.design}-{self.seed}"

    @property
    def name(self) -> str:
        """Folder and file without ending, as `OnnxPolicy.name` has it."""
        return f"{self.path.parent.name}/{self.path.stem}"

    @property
    def family(self) -> str:
        """Family of the design that was trained, `hyperleg` where the training does not say."""
        try:
            design = json.loads((self.path.parent / RUN).read_text())["design"]
            return str(design.get("family", "hyperleg"))
        except (OSError, ValueError, KeyError, AttributeError, TypeError):
            return "hyperleg"


@dataclass(frozen=True)
class Packed:
    """What became of one training when a campaign was packed."""

    training: str
    policies: int
    """ONNX files; 0 where the training is not finished and was left out."""
    size: int
    """Size of the folder [byte]."""


def shipped_policies(folder: str | Path | None = None, *, late: bool = True) -> list[Shipped]:
    """List the policies of all finished trainings of a folder.

    Args:
        folder: of trainings; the shipped ones by default.
        late: also the late policies.

    Returns:
        The policies by group, design and seed, the last policy of each training first.

    Raises:
        InputError: a folder that was asked for and is not there, or that is a training itself.
    """
    place = Path(folder) if folder is not None else shipped_folder()
    if not place.is_dir():
        if folder is None:
            return []
        raise InputError(
            "policies",
            "",
            str(folder),
            "no such folder; expects one with a folder a training, such as walk_upright-toe-1",
        )
    if folder is not None and (place / POLICY).is_file():
        raise InputError(
            "policies",
            "",
            str(folder),
            "is the folder of one training; expects the folder that holds it, under a name such as "
            "walk_upright-toe-1",
        )
    policies = []
    for training in place.iterdir():
        name = _NAME.fullmatch(training.name)
        if name is None or not (training / POLICY).is_file():
            continue
        files = [training / POLICY, *(sorted(training.glob(LATE), reverse=True) if late else [])]
        policies += [
            Shipped(name["group"], name["design"], int(name["seed"]), i, file)
            for i, file in enumerate(files)
        ]
    return sorted(
        policies, key=lambda policy: (policy.group, policy.design, policy.seed, policy.late)
    )


def unfinished_trainings(folder: str | Path) -> list[Shipped]:
    """List the trainings of a folder that were begun and have no policy yet.

    Args:
        folder: of trainings.

    Returns:
        What will be their policies, by the trainings' names.
    """
    begun = []
    for training in sorted(Path(folder).iterdir()):
        name, policy = _NAME.fullmatch(training.name), training / POLICY
        if name and (training / RUN).is_file() and not policy.is_file():
            begun.append(Shipped(name["group"], name["design"], int(name["seed"]), 0, policy))
    return begun


def check_different(paths: Iterable[str | Path], where: str = "policies") -> None:
    """Check that no two files hold the same policy, which would count one training twice.

    Args:
        paths: of ONNX files.
        where: what the error names as the place.

    Raises:
        InputError: two files with the same content.
    """
    seen: dict[str, Path] = {}
    for path in map(Path, paths):
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        if digest in seen:
            twin = seen[digest]
            raise InputError(
                where,
                "",
                f"{path.parent.name}/{path.name}",
                f"is the same policy as {twin.parent.name}/{twin.name}; a training counts once",
            )
        seen[digest] = path


def find_policy(name: str | Path, where: str = "policy") -> Path:
    """Find the file of a policy.

    Args:
        name: an ONNX file, the folder of a training, or the name of a shipped training; of a
            training, its last policy is meant.
        where: option that names it, for the error.

    Returns:
        The path of the ONNX file.

    Raises:
        InputError: none of these, which lists what is shipped, or a training that is not finished,
            or another folder.
    """
    path = Path(name)
    if path.is_file():
        return path
    folder = path.parent if path.name == POLICY else path
    if (folder / POLICY).is_file():
        return folder / POLICY
    if (folder / "run.json").is_file():
        raise InputError(where, "", str(name), f"the training is not finished; {GOES_ON}")
    named = shipped_folder() / path / POLICY
    if len(path.parts) == 1 and named.is_file():
        return named
    if path.is_dir():
        remedy = f"is a folder without {POLICY}; expects an ONNX file or the folder of a training"
        raise InputError(where, "", str(name), remedy)
    known = [policy.training for policy in shipped_policies(late=False)]
    shipped = f"Shipped, with their seeds: {trainings_text(known) or 'none'}"
    remedy = f"{meant(str(name), known, 'no near name.')} {shipped}"
    raise InputError(where, "", str(name), f"no such file; {remedy}")


def trainings_text(names: Iterable[str]) -> str:
    """Write names of trainings briefly, consecutive seeds together.

    Args:
        names: such as `walk_upright-toe-1`.

    Returns:
        Such as `walk_upright-toe-1..4, walk_upright-toe-6`.
    """
    seeds: dict[str, list[int]] = {}
    for name in names:
        training, seed = name.rsplit("-", 1)
        seeds.setdefault(training, []).append(int(seed))
    texts = []
    for training, own in seeds.items():
        for first in sorted(own):
            if first - 1 not in own:  # the first of consecutive ones
                last = next(s for s in itertools.count(first) if s + 1 not in own)
                texts.append(f"{training}-{first}" + (f"..{last}" if last > first else ""))
    return ", ".join(texts)


def learning_curve(training: str | Path, rows: int = CURVE_ROWS) -> list[dict[str, float]]:
    """Read the learning curve of a training.

    Numbers that were not measured (no step, so no speed) are left out of means. A line that was cut
    off when the training was killed is skipped.

    Args:
        training: its folder.
        rows: most rows; longer records are averaged over stretches of equal length.

    Returns:
        Rows of the columns `CURVE`, some of which a row may lack; empty where there is no record.
    """
    lines = []
    path = Path(training) / PROGRESS
    if path.is_file():
        for line in path.read_text(encoding="utf-8").splitlines():
            try:
                lines.append(json.loads(line))
            except ValueError:
                continue
    length = max(1, math.ceil(len(lines) / rows))
    return [_mean(lines[i : i + length]) for i in range(0, len(lines), length)]


def pack(
    source: str | Path, target: str | Path, ship: Mapping[str, str] | None = None
) -> list[Packed]:
    """Copy all finished trainings of a folder in the form in which they are shipped; each is
    written whole or not at all.

    Trainings of the target that the source does not have stay.

    Args:
        source: folder of trainings, such as `results/campaign`.
        target: such as `sim/policies`.
        ship: what to copy of a group's trainings: `all` with late policies, the `last` policy
            and its critic, the `policy` alone, or `none`. All by default.

    Returns:
        One a training of the source, by name.

    Raises:
        InputError: no such folder, or no training in it.
        OutputError: a training's folder in the target is somebody else's, or cannot be written.
    """
    place = Path(source)
    if not place.is_dir():
        raise InputError("pack", "from", str(source), "no such folder")
    wanted = {} if ship is None else ship
    trainings = sorted(p for p in place.iterdir() if p.is_dir() and _NAME.fullmatch(p.name))
    if not trainings:
        raise InputError(
            "pack",
            "from",
            str(source),
            "holds no training; expects folders such as walk-toe-0",
        )
    packed = []
    for training in trainings:
        what = wanted.get(training.name.split("-")[0], "all")
        if what == "none":
            continue
        if not (training / POLICY).is_file():
            packed.append(Packed(training.name, 0, 0))
            continue
        policies = [training / POLICY]
        files = [training / POLICY, training / RUN]
        if what != "policy":
            files.append(training / CRITIC)
        if what == "all":
            policies += sorted(training.glob(LATE))
            files += policies[1:]
        with output_folder(Path(target) / training.name) as folder:
            for file in files:
                if file.is_file() and file.suffix == ".onnx":
                    write_bytes(
                        folder / file.name,
                        halve_weights(file.read_bytes(), f"{training.name}/{file.name}"),
                    )
                elif file.is_file():
                    shutil.copyfile(file, folder / file.name)
            write_text(
                folder / PROGRESS,
                "".join(json.dumps(row) + "\n" for row in learning_curve(training)),
            )
        destination = Path(target) / training.name
        packed.append(
            Packed(
                training.name, len(policies), sum(f.stat().st_size for f in destination.iterdir())
            )
        )
    return packed


def pack_text(packed: Iterable[Packed]) -> str:
    """Describe what was packed, for a terminal.

    Args:
        packed: trainings.

    Returns:
        One line for each training, and a sum.
    """
    packed = list(packed)
    lines = [
        f"{p.training:<34} {p.policies} policies, {p.size / 1e6:.1f} MB"
        if p.policies
        else f"{p.training:<34} not finished"
        for p in packed
    ]
    done = [p for p in packed if p.policies]
    policies, size = sum(p.policies for p in done), sum(p.size for p in done)
    return "\n".join(
        [
            *lines,
            f"{len(done)} of {len(packed)} trainings, {policies} policies, {size / 1e6:.1f} MB",
        ]
    )


def _mean(rows: list[dict[str, Any]]) -> dict[str, float]:
    """Mean of rows; steps and stage are those of the last."""
    means: dict[str, float] = {}
    for key in CURVE:
        values = [row[key] for row in rows if isinstance(row.get(key), int | float)]
        if values:
            means[key] = (
                values[-1]
                if key in ("steps", "stage")
                else float(f"{sum(values) / len(values):.5g}")
            )
    return means
