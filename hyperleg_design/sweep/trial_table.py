"""What the trials of a sweep say of each design: means of its best policy with intervals, limits
that act, fronts with uncertainty, and which parameter each measure follows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.evaluation.measure_interval import measure_interval
from hyperleg_design.evaluation.result import counted
from hyperleg_design.robot.load import design_argument
from hyperleg_design.robot.motors import folder_option
from hyperleg_design.sweep import registry
from hyperleg_design.sweep.pareto import nondominated
from hyperleg_design.sweep.spaces.definition import AS_DESCRIBED, Sweep
from hyperleg_design.sweep.trial_runs import REJECTED
from hyperleg_design.sweep.trials.best_policy import reported_trials

if TYPE_CHECKING:
    import pandas as pd

SHOWN = {
    "walk": (
        "arrived",
        "fell",
        "cost_of_transport",
        "grf_peak_body_weights",
        "continuous_use",
        "mean_speed",
        "limit_share",
        "thermal_peak",
    ),
    "t_test": (
        "arrived",
        "fell",
        "time",
        "mean_deviation",
        "cost_of_transport",
        "grf_peak_body_weights",
        "continuous_use",
        "limit_share",
        "thermal_peak",
    ),
}
"""Measures with an interval in every table of evaluated designs, by protocol."""
ENVELOPE, HEAT, SPEED = "envelope", "heat", "speed"
ENVELOPE_SHARE = 0.01
"""Share of time on the edge of its envelope from which that limits the motor; assumed."""
HEAT_PEAK = 1.0
"""Moving average of squared torque over rated torque from which heat limits a motor."""
SPEED_SHARE = 0.95
"""Peak speed over no-load speed from which speed limits a motor; assumed."""
FEWEST_ARRIVALS = 0.95
"""Share of arrivals from which a design counts as one that walks; assumed."""
_RESAMPLES = 1000
"""Number of resamples of the bootstrap of each design's interval."""
_DRAWS = 400
"""Number of draws of all objectives from which the probability of being on the front is
estimated."""
_Z = 1.96


def design_table(sweep: Sweep, trials: pd.DataFrame, columns: Mapping[str, Any]) -> pd.DataFrame:
    """Summarise in one row how each design's best policy walks; see `reported_trials`.

    Args:
        sweep: the definition.
        trials: of `run_trials`.
        columns: sample, variant, axes and measures of the sweep's own table.

    Returns:
        Those columns and, for each protocol, the mean of every measure (`walk.cost_of_transport`)
        over the reported trials that did not fall, of outcomes over all reported ones; `.low` and
        `.high` of the `SHOWN` ones, `.trials` (number of those reported), `.policy` (name of the
        best), `.trained` (whether it was trained for the design), `.outside` (parameters outside
        its trained range), `.limits` (which act), and `.reason` where a design could not be
        simulated. Trials that fell are left out because height that is lost in a fall is energy
        that is gained: their cost of transport may even be negative.
    """
    import pandas as pd

    rows = []
    keys = zip(columns["sample"], columns["variant"], strict=True)
    index = {key: i for i, key in enumerate(keys)}
    for (sample, variant), own in trials.groupby(["sample", "variant"], sort=False):
        row = {name: values[index[sample, variant]] for name, values in columns.items()}
        for protocol, part in own.groupby("protocol", sort=False):
            row |= {f"{protocol}.{k}": v for k, v in _of_protocol(str(protocol), part).items()}
        rows.append(row)
    order = {name: i for i, name in enumerate(sweep.variants)}
    rows.sort(key=lambda row: (row["sample"], order[row["variant"]]))
    return pd.DataFrame(rows)


def _of_protocol(protocol: str, own: pd.DataFrame) -> dict[str, Any]:
    if (own["outcome"] == REJECTED).any():
        return {"reason": str(own["reason"].iloc[0]), "trials": 0}
    part = reported_trials(own)
    row: dict[str, Any] = {"trials": len(part), "reason": ""}
    known = registry.PROTOCOLS[protocol]
    for name in (*known, *(c for c in map(str, part) if registry.is_waypoint(protocol, c))):
        if name not in part:
            continue
        values = counted(part, name).to_numpy(float)
        if name in SHOWN[protocol]:
            interval = measure_interval(name, [values], resamples=_RESAMPLES)
            row |= {name: interval.mean, f"{name}.low": interval.low, f"{name}.high": interval.high}
        else:
            real = values[np.isfinite(values)]
            row[name] = float(real.mean()) if real.size else np.nan
    row |= {name: str(part[name].iloc[0]) for name in ("policy", "trained", "outside")}
    row["limits"] = acting_limits(part)
    return row


def acting_limits(part: pd.DataFrame) -> str:
    """Name the limits of the motors that act in the mean over trials.

    Args:
        part: trials of one design and policy.

    Returns:
        Envelope, heat, speed, or none.
    """
    acting = []
    for name, column, level in (
        (ENVELOPE, "limit_share", ENVELOPE_SHARE),
        (HEAT, "thermal_peak", HEAT_PEAK),
        (SPEED, "speed_use", SPEED_SHARE),
    ):
        values = part[column].to_numpy(float)
        values = values[np.isfinite(values)]
        if values.size and values.mean() > level:
            acting.append(name)
    return ", ".join(acting) or "none"


def sensitivities(
    sweep: Sweep, designs: pd.DataFrame, names: Sequence[str]
) -> list[dict[str, Any]]:
    """Compute how each measure follows each parameter, over all designs of a variant.

    For parameters with positive numbers it is the elasticity b of ln m = a + sum b ln x, by least
    squares over all of them together: the percentage by which the measure changes where the
    parameter grows by one per cent. Its effect is `exp(|b| ln(high / low)) - 1`, over the whole
    axis. For others (motors), the effect is the spread between the levels' means over their
    smallest.

    Args:
        sweep: the definition.
        designs: one row for each design.
        names: of the measures.

    Returns:
        `variant`, `measure`, `parameter`, `elasticity` with `low` and `high` (None for texts),
        `effect`, sorted by it for each measure.
    """
    rows: list[dict[str, Any]] = []
    for variant, own in designs.groupby("variant", sort=False):
        for name in names:
            if name not in own:
                continue
            part = own[np.isfinite(own[name].astype(float)) & (own[name] > 0)]
            fitted = _elasticities(sweep, part, name) + _spreads(sweep, part, name)
            fitted.sort(key=lambda row: -row["effect"])
            rows += [{"variant": str(variant), "measure": name, **row} for row in fitted]
    return rows


def _elasticities(sweep: Sweep, part: pd.DataFrame, name: str) -> list[dict[str, Any]]:
    axes = [
        a.name
        for a in sweep.axes
        if a.numeric and (part[a.name] > 0).all() and part[a.name].nunique() > 1
    ]
    if not axes or len(part) < len(axes) + 2:
        return []
    matrix = np.column_stack([np.ones(len(part)), *(np.log(part[a]) for a in axes)])
    target = np.log(part[name].to_numpy(float))
    solution, *_ = np.linalg.lstsq(matrix, target, rcond=None)
    residual = target - matrix @ solution
    variance = residual @ residual / max(len(part) - matrix.shape[1], 1)
    error = np.sqrt(np.diag(np.linalg.pinv(matrix.T @ matrix)) * variance)
    return [
        {
            "parameter": axis,
            "elasticity": float(solution[i]),
            "low": float(solution[i] - _Z * error[i]),
            "high": float(solution[i] + _Z * error[i]),
            "effect": float(np.expm1(abs(solution[i]) * np.ptp(matrix[:, i]))),
        }
        for i, axis in enumerate(axes, 1)
    ]


def _spreads(sweep: Sweep, part: pd.DataFrame, name: str) -> list[dict[str, Any]]:
    rows = []
    for axis in sweep.axes:
        if axis.numeric or part[axis.name].nunique() < 2:
            continue
        means = part.groupby(axis.name)[name].mean()
        effect = float(means.max() / means.min() - 1)
        unknown = dict.fromkeys(("elasticity", "low", "high"))
        rows.append({"parameter": axis.name, **unknown, "effect": effect})
    return rows


def front(designs: pd.DataFrame, objectives: Sequence[str], seed: int = 0) -> pd.DataFrame:
    """Designs that are, or may be, on the Pareto front of their variant.

    Objectives of trials are uncertain: the probability of being on the front is the share of draws,
    from independent normal distributions of the intervals' widths, in which no other design is
    better in all. Designs that do not walk are left out; see `walks`.

    Args:
        designs: one row for each design.
        objectives: names of the measures.
        seed: of the draws.

    Returns:
        Rows of `designs` with `on_front` (of the means) and `front_probability`, the likeliest
        first; those above zero.
    """
    import pandas as pd

    better = [registry.entry(name).better or "low" for name in objectives]
    parts = []
    for _, part in designs.groupby("variant", sort=False):
        own = part[walks(part)].copy()
        if own.empty:
            continue
        mean = own[list(objectives)].to_numpy(float)
        width = np.column_stack([_error(own, name) for name in objectives])
        rng = np.random.default_rng(seed)
        count = np.zeros(len(own))
        for _draw in range(_DRAWS):
            count += nondominated(mean + width * rng.standard_normal(mean.shape), better)
        own["on_front"] = nondominated(mean, better)
        own["front_probability"] = count / _DRAWS
        own = own[own["on_front"] | (own["front_probability"] > 0)]
        parts.append(own.sort_values("front_probability", ascending=False, kind="stable"))
    return pd.concat(parts, ignore_index=True) if parts else designs.iloc[:0]


def walks(designs: pd.DataFrame) -> np.ndarray:
    """Decide which designs walk: they were simulated and arrive in at least the share
    `FEWEST_ARRIVALS` of the reported trials of each protocol.

    Arrivals count rather than falls, because a robot that only stands never falls.

    Args:
        designs: one row for each of n designs, of `design_table`.

    Returns:
        `(n,)`.
    """
    good = np.ones(len(designs), bool)
    for protocol in registry.PROTOCOLS:
        if f"{protocol}.arrived" in designs:
            good &= (designs[f"{protocol}.arrived"] >= FEWEST_ARRIVALS).to_numpy()
    return good


def best(designs: pd.DataFrame, objectives: Sequence[str], count: int = 5) -> pd.DataFrame:
    """List the best designs that walk.

    Args:
        designs: one row for each design.
        objectives: names of the measures.
        count: designs for each objective.

    Returns:
        Rows of `designs` with `by`, the objective.
    """
    import pandas as pd

    good = designs[walks(designs)]
    parts = []
    for name in objectives:
        ascending = registry.entry(name).better != "high"
        own = good[np.isfinite(good[name].astype(float))].sort_values(
            name, ascending=ascending, kind="stable"
        )
        parts.append(own.head(count).assign(by=name))
    return pd.concat(parts, ignore_index=True) if parts else good


def build_command(sweep: Sweep, row: Mapping[str, Any]) -> str:
    """Write the command that builds one design of a sweep.

    Args:
        sweep: the definition.
        row: of the design, with its values on the axes.

    Returns:
        The command line.
    """
    design = design_argument(sweep.base)
    return f"hyperleg build --design {design}{_options(sweep, row)} --out built"


def view_command(sweep: Sweep, row: Mapping[str, Any]) -> str:
    """Write the command that shows one design of a sweep in three dimensions.

    Args:
        sweep: the definition.
        row: of the design, with its values on the axes.

    Returns:
        The command line.
    """
    return f"hyperleg view {design_argument(sweep.base)}{_options(sweep, row)}"


def _options(sweep: Sweep, row: Mapping[str, Any]) -> str:
    """Options that turn a sweep's base into one of its designs."""
    settings: dict[str, Any] = {
        path: sweep.base[path]
        for path, origin in sweep.base.origins.items()
        if origin.label == "user" and origin.source.endswith("set")
    }
    for axis in sweep.axes:
        leaf = axis.leaf_values(sweep.base, np.asarray([row[axis.name]]))
        settings |= {path: np.asarray(value)[0] for path, value in leaf.items()}
    changes = "".join(f" --set '{path}={_yaml(value)}'" for path, value in settings.items())
    variant = "" if row["variant"] == AS_DESCRIBED else f" --variant {row['variant']}"
    return f"{variant}{folder_option()}{changes}"


def _yaml(value: Any) -> str:
    if np.ndim(value):
        return "[" + ", ".join(f"{float(v):.10g}" for v in np.ravel(value)) + "]"
    return f"{float(value):.10g}" if isinstance(value, float | np.floating) else str(value)


def _error(designs: pd.DataFrame, name: str) -> np.ndarray:
    if f"{name}.low" not in designs:
        return np.zeros(len(designs))
    width = (designs[f"{name}.high"] - designs[f"{name}.low"]).to_numpy(float) / (2 * _Z)
    return np.nan_to_num(width)
