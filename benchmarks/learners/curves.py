"""Curves of trainings over the processor time they took, thinned, as JSON and a figure.

    python benchmarks/learners/curves.py results/learners/* --out docs/learner

Each folder holds the `progress.jsonl` of `hyperleg train` or `off_policy.py`.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

POINTS = 40
"""Of each curve, at most."""
MEASURES = ("steps", "processor_minutes", "assist", "falls", "speed", "reward")
TRIAL = ("survival", "speed", "speed_error", "cost_of_transport", "cadence")


def curve(folder: Path) -> dict[str, Any]:
    """A training's measures, means over equal parts of its iterations, and all its trials."""
    rows = [json.loads(line) for line in (folder / "progress.jsonl").read_text().splitlines()]
    size = max(1, -(-len(rows) // POINTS))
    parts = [rows[i : i + size] for i in range(0, len(rows), size)]
    points = {
        name: [round(sum(row[name] for row in part) / len(part), 4) for part in parts]
        for name in MEASURES
    }
    trials = [
        {
            "steps": row["steps"],
            "processor_minutes": round(row["processor_minutes"], 3),
            **{k: None if row["trial"][k] is None else round(row["trial"][k], 3) for k in TRIAL},
        }
        for row in rows
        if row.get("trial")
    ]
    return {"training": folder.name, "points": points, "trials": trials}


def figure(curves: list[dict[str, Any]], path: Path) -> None:
    """Falls and speed while training, and the speed error of trials, over processor minutes."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig, (falls, speed, error) = plt.subplots(1, 3, figsize=(13, 3.6), layout="constrained")
    for each in curves:
        points, label = each["points"], each["training"]
        falls.plot(points["processor_minutes"], points["falls"], label=label)
        speed.plot(points["processor_minutes"], points["speed"], label=label)
        walked = [t for t in each["trials"] if t["speed_error"] is not None]
        error.plot(
            [t["processor_minutes"] for t in walked],
            [t["speed_error"] for t in walked],
            "o-",
            label=label,
        )
    falls.set(ylabel="falls a robot's minute, with assist", yscale="symlog", ylim=(0, None))
    speed.set(ylabel="speed in training [m/s]", ylim=(0, 1.6))
    error.set(ylabel="speed error of trials, no assist [m/s]", ylim=(0, 1.4))
    for axis in (falls, speed, error):
        axis.set(xlabel="processor minutes")
        axis.grid(alpha=0.3)
    falls.legend(fontsize=7)
    fig.savefig(path, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--out", type=Path, default=Path("docs/learner"))
    given = parser.parse_args()
    curves = [curve(folder) for folder in given.folders]
    given.out.mkdir(parents=True, exist_ok=True)
    lines = ",\n".join(json.dumps(each) for each in curves)
    (given.out / "curves.json").write_text(f"[\n{lines}\n]\n")
    figure(curves, given.out / "curves.png")


if __name__ == "__main__":
    main()
