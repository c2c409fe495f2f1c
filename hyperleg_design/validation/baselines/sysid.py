"""`mujoco.sysid`: Gauss-Newton on whole-log position errors by MuJoCo's own rollouts, on the
parameters of `drive_set`.

The tool's own path: `optimize` with `build_residual_fn` on a spec with position servos. Armature,
damping, friction and bias are modifiers of that spec; the delay shifts the controls in a custom
rollout; the bias is added to the sensors in a custom residual, which is left in rad as PACE's is.
Limits of coupled motors, which no servo at a joint can have, are left out.
"""

from __future__ import annotations

import contextlib
import io
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.model.rig_spec import SENSOR, rig_spec
from hyperleg_design.gap.playback.windows import whole_log
from hyperleg_design.gap.signals.channels import held
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.validation.baselines.drive_set import KINDS, DriveSet, Fitted, check_logs
from hyperleg_design.validation.baselines.rollout import STEP

ITERATIONS = 60
DELAY = "delay"
START = 0.02
"""Distance of the first values from bounds they lie on, over the range: the optimizer stalls on
bounds."""


class _Enough(Exception):
    """The budget is used up."""


def fit_sysid(signals: Sequence[Signals], drives: DriveSet, *, seconds: float = np.inf) -> Fitted:
    """Fit the parameters by `mujoco.sysid.optimize`.

    Args:
        signals: conditioned logs with targets and gains, base fixed.
        drives: parameters of the robot.
        seconds: budget.

    Raises:
        InputError: logs that cannot be replayed, or `mujoco.sysid` is not installed.
    """
    sysid = _toolbox()
    check_logs(signals)
    begun = time.perf_counter()
    subject = drives.subject
    scale = np.minimum(drives.spread * 10, drives.high - drives.low)
    lower, upper = drives.low / scale, drives.high / scale
    params = sysid.ParameterDict()
    names = [f"{kind}_{joint}" for kind in KINDS for joint in subject.joints] + [DELAY]
    for i, name in enumerate(names):
        margin = START * (upper[i] - lower[i])
        params.add(
            sysid.Parameter(
                name,
                nominal=float(np.clip(0.0, lower[i] + margin, upper[i] - margin)),
                min_value=float(lower[i]),
                max_value=float(upper[i]),
                modifier=_modifier(name, scale[i], subject),
            )
        )
    sequences = [
        _sequence(sysid, log_signals, drives, number) for number, log_signals in enumerate(signals)
    ]
    history: list[tuple[float, np.ndarray]] = []
    evaluations = 0
    best = np.inf

    def custom_residual(
        given: Any, predicted: Any, measured: Any, model: Any, everything: bool, **_: Any
    ) -> tuple[np.ndarray, Any, Any]:
        bias = np.array([given[f"bias_{j}"].value[0] for j in subject.joints]) * drives.part(
            scale, "bias"
        )
        sampled = predicted.resample(measured.times)
        return sampled.data + bias - measured.data, sampled, measured

    def custom_rollout(
        models: Any,
        datas: Any,
        control_signal: Any,
        initial_states: Any,
        param_dicts: Any,
        **mapping: Any,
    ) -> Any:
        per = len(models) // len(param_dicts)
        late = [param_dicts[i // per][DELAY].value[0] * scale[-1] for i in range(len(models))]
        shifted = [
            _shifted(sysid, control, delay)
            for control, delay in zip(control_signal, late, strict=True)
        ]
        return sysid.sysid_rollout(
            models=models,
            datas=datas,
            control_signal=shifted,
            initial_states=initial_states,
            **mapping,
        )

    inner = sysid.build_residual_fn(
        models_sequences=sequences,
        modify_residual=custom_residual,
        custom_rollout=custom_rollout,
        n_threads=1,
    )

    def residual(x: np.ndarray, given: Any, **options: Any) -> Any:
        nonlocal evaluations, best
        residuals = inner(x, given, **options)
        evaluations += 1 if x.ndim == 1 else x.shape[1]
        if x.ndim == 1 or x.shape[1] == 1:
            value = float(sum(np.sum(np.square(r)) for r in residuals[0]))
            if value < best:
                best = value
                history.append((time.perf_counter() - begun, np.asarray(x, float).ravel() * scale))
        if time.perf_counter() - begun > seconds:
            raise _Enough
        return residuals

    try:
        with contextlib.redirect_stdout(io.StringIO()):  # the optimizer prints its iterations
            sysid.optimize(
                initial_params=params,
                residual_fn=residual,
                optimizer="mujoco",
                verbose=False,
                max_iters=ITERATIONS,
            )
        stopped = "finished"
    except _Enough:
        stopped = f"{seconds:g} s"
    taken = time.perf_counter() - begun
    values = history[-1][1] if history else np.zeros(drives.count)
    return Fitted(
        "sysid",
        np.clip(values, drives.low, drives.high),
        taken,
        evaluations,
        tuple(history),
        stopped,
    )


def _toolbox() -> Any:
    try:
        from mujoco import sysid
    except ImportError:
        sysid = None
    if not hasattr(sysid, "optimize"):
        raise InputError(
            "baselines", "sysid", None, "needs mujoco[sysid]: install hyperleg-design[baselines]"
        )
    return sysid


def _modifier(name: str, scale: float, subject: Any) -> Any:
    """How one parameter changes the spec."""
    if name == DELAY:
        return None
    kind, _, joint = name.partition("_")
    at = subject.joints.index(joint)
    own = {
        "friction": subject.coulomb[at],
        "damping": subject.viscous[at],
        "armature": subject.armature[at, at] if subject.one_to_one else 0.0,
    }

    def change(spec: Any, parameter: Any) -> None:
        value = float(parameter.value[0]) * scale
        target = spec.joint(joint)
        if kind == "armature":
            target.armature = max(float(own[kind]) + value, 0.0)
        elif kind == "damping":
            target.damping = [max(float(own[kind]) + value, 0.0), 0, 0]
        elif kind == "friction":
            target.frictionloss = max(float(own[kind]) + value, 0.0)
        elif not subject.passive[at]:
            spec.actuator(joint).biasprm[0] = -float(subject.gains[at, 0]) * value

    return change


def _sequence(sysid: Any, signals: Signals, drives: DriveSet, number: int) -> Any:
    """One log as the toolbox takes it."""
    subject = drives.subject
    substeps = max(int(np.ceil(signals.step / STEP - 1e-9)), 1)
    spec = rig_spec(subject, signals.step / substeps)
    model = spec.compile()
    ticks = whole_log(signals).ticks[0]
    times = signals.time[ticks] - signals.time[ticks[0]]
    driven = [i for i in range(len(subject.joints)) if not subject.passive[i]]
    # A controller holds a target until the next one: the toolbox interpolates, so each is given
    # twice.
    assert signals.target is not None
    targets = held(signals.target, subject.default)[ticks][:, driven]
    edge = 1e-6
    when = np.concatenate([[times[0]], np.stack([times[1:] - edge, times[1:]], -1).ravel()])
    control = np.concatenate(
        [targets[:1], np.stack([targets[:-1], targets[1:]], 1).reshape(-1, targets.shape[1])]
    )
    state = sysid.create_initial_state(
        model, signals.position[ticks[0]], signals.velocity[ticks[0]]
    )
    inside = np.flatnonzero(signals.valid[ticks])[1:]
    positions = sysid.TimeSeries.from_names(
        times[inside], signals.position[ticks][inside], model, [SENSOR + j for j in subject.joints]
    )
    return sysid.ModelSequences(
        f"log_{number}", spec, f"log_{number}", state, sysid.TimeSeries(when, control), positions
    )


def _shifted(sysid: Any, control: Any, delay: float) -> Any:
    """Controls that come later, held at the first before."""
    times = control.times
    late = np.stack(
        [np.interp(times - max(delay, 0.0), times, column) for column in control.data.T], -1
    )
    return sysid.TimeSeries(times, late, control.signal_mapping)
