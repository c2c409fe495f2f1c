"""What a joint or motor was doing where its gap is largest for its time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.results.diagnosis import Place
from hyperleg_design.gap.signals.signals import RESIDUALS

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.judge import Judge
    from hyperleg_design.gap.signals.signals import Signals


def worst(judge: Judge, name: str, kind: str) -> Place | None:
    """What a joint or motor was doing where its residual is largest for its time."""
    if kind not in ("joint", "motor"):
        return None
    left = judge.nothing.held.left
    samples = judge.base.samples
    best: tuple[float, str, float] | None = None
    total: dict[str, float] = {}
    ticks: dict[str, float] = {}
    for row in samples.rows:
        if row.name != name or RESIDUALS[row.residual_name][0] != kind:
            continue
        for one, filtered_log in enumerate(samples.filtered_logs):
            own = [
                i
                for i, r in enumerate(filtered_log.rows)
                if (r.residual_name, r.column) == (row.residual_name, row.column)
            ]
            if not own:
                continue
            part = samples.where[one][own[0]]
            index = np.clip(
                np.round(samples.time[part] / filtered_log.signals.step).astype(int),
                0,
                len(filtered_log.signals.time) - 1,
            )
            for regime, mask in regimes(
                filtered_log.signals, row.residual_name, row.column
            ).items():
                chosen = mask[index]
                total[regime] = total.get(regime, 0.0) + float((left[part][chosen] ** 2).sum())
                ticks[regime] = ticks.get(regime, 0.0) + float(samples.share[part][chosen].sum())
                total["all"] = total.get("all", 0.0) + (
                    float((left[part] ** 2).sum()) if regime == "forward" else 0.0
                )
    for regime, value in total.items():
        if (
            regime != "all"
            and ticks[regime] > 0
            and total["all"] > 0
            and value / total["all"] >= 0.2
        ):
            density = value / ticks[regime]
            if best is None or density > best[0]:
                best = (density, regime, value / total["all"])
    return None if best is None else Place(name, kind, best[1], min(best[2], 1.0))


def regimes(signals: Signals, residual_name: str, column: int) -> dict[str, np.ndarray]:
    """What a joint or motor was doing `(t,)` of bool each."""
    velocity = (
        signals.velocity[:, column]
        if residual_name == "motion"
        else signals.velocity @ signals.subject.joint_from_motor[:, column]
    )
    speed = np.abs(velocity)
    middle = np.median(speed)
    reach = max(round(0.05 / signals.step), 1)
    turns = np.flatnonzero(np.diff(np.sign(velocity)) != 0)
    reversal = np.zeros(len(speed), bool)
    for turn in turns.tolist():
        reversal[max(turn - reach, 0) : turn + reach + 1] = True
    found = {
        "forward": velocity >= 0,
        "backward": velocity < 0,
        "slow": speed < middle,
        "fast": speed >= middle,
        "reversal": reversal,
    }
    if residual_name == "motion":
        load = np.abs(signals.rigid[:, column])
        found |= {"light load": load < np.median(load), "heavy load": load >= np.median(load)}
        place = signals.position[:, column]
        found |= {
            "low posture": place < np.median(place),
            "high posture": place >= np.median(place),
        }
    return found
