"""Whether an MJCF file is a robot that MuJoCo can simulate."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import in_short
from hyperleg_design.robot.checks.check_units import check_ends, check_step
from hyperleg_design.robot.checks.finding import Finding
from hyperleg_design.robot.checks.urdf_xml import parse_xml

LARGEST_TIME_STEP = 0.02
"""Step past which contacts and motors no longer behave [s]."""
DEEPEST_CONTACT = 0.01
"""Penetration in a keyframe past which the robot jumps when started there [m]."""


def check_mjcf(source: str | Path) -> list[Finding]:
    """Everything wrong with an MJCF file: syntax, what MuJoCo's compiler refuses, and what it lets
    pass.

    Args:
        source: a path, or the text itself.

    Returns:
        Findings, errors first; empty where nothing is wrong.

    Raises:
        InputError: the file cannot be read.
    """
    import mujoco

    root, findings = parse_xml(source, "mujoco", "an MJCF file starts with <mujoco>")
    if root is None:
        return findings
    is_text = isinstance(source, str) and source.lstrip().startswith("<")
    try:
        spec = (
            mujoco.MjSpec.from_string(source) if is_text else mujoco.MjSpec.from_file(str(source))
        )
        model = spec.compile()
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        return [
            Finding(
                "error",
                "<mujoco>",
                f"MuJoCo does not compile it: {in_short(error, 300)}",
                "correct what it names",
            )
        ]
    findings = _model(model) + _units(model) + _starts(model)
    return sorted(findings, key=lambda f: f.severity != "error")


def _model(model: Any) -> list[Finding]:
    import mujoco

    findings = []
    if not model.nv:
        findings.append(Finding("error", "<worldbody>", "nothing moves", "add joints"))
    if not model.nu:
        findings.append(
            Finding("warning", "<actuator>", "there are no actuators", "add one a motor")
        )
    if model.opt.timestep > LARGEST_TIME_STEP:
        findings.append(
            Finding(
                "warning",
                "<option>",
                f"timestep is {model.opt.timestep:g} s",
                f"stay below {LARGEST_TIME_STEP:g} s",
            )
        )
    for index in range(model.nu):
        low, high = model.actuator_ctrlrange[index]
        if model.actuator_ctrllimited[index] and low >= high:
            findings.append(
                Finding(
                    "error",
                    f"actuator {model.actuator(index).name}",
                    f"control range is {low:g} .. {high:g}, empty",
                    "widen it",
                )
            )
    for index in range(model.njnt):
        place, (low, high) = f"joint {model.joint(index).name}", model.jnt_range[index]
        if model.jnt_limited[index] or int(model.jnt_type[index]) not in (
            int(mujoco.mjtJoint.mjJNT_HINGE),
            int(mujoco.mjtJoint.mjJNT_SLIDE),
        ):
            continue
        if low > high:  # MuJoCo takes it for a joint without limits
            findings.append(
                Finding(
                    "error", place, f"range is {low:.4g} .. {high:.4g}, reversed", "swap its ends"
                )
            )
        else:
            findings.append(
                Finding("warning", place, "has no range", "add range= if the joint has stops")
            )
    return findings


def _units(model: Any) -> list[Finding]:
    """Distances and ranges that look like millimetres and degrees, by the rules of a URDF's."""
    import mujoco

    findings = []
    for body in range(1, model.nbody):
        parent = model.body(int(model.body_parentid[body])).name
        findings += check_step(f"body {model.body(body).name}", parent, model.body_pos[body])
    for index in range(model.njnt):
        if int(model.jnt_type[index]) == int(mujoco.mjtJoint.mjJNT_HINGE):
            lower, upper = model.jnt_range[index]
            findings += check_ends(f"joint {model.joint(index).name}", lower, upper)
    return findings


def _starts(model: Any) -> list[Finding]:
    """Whether each keyframe, or the zero posture, is a state to start from."""
    import mujoco

    findings = []
    data = mujoco.MjData(model)
    for key in range(model.nkey) if model.nkey else [-1]:
        place = f"keyframe {model.key(key).name}" if key >= 0 else "zero posture"
        if key >= 0:
            mujoco.mj_resetDataKeyframe(model, data, key)
        mujoco.mj_forward(model, data)
        if not np.all(np.isfinite(data.qacc)):
            findings.append(
                Finding(
                    "error",
                    place,
                    "accelerations are not finite",
                    "check masses, inertias and contacts",
                )
            )
        depth = -float(np.min(data.contact.dist, initial=0.0))
        if depth > DEEPEST_CONTACT:
            findings.append(
                Finding(
                    "warning",
                    place,
                    f"bodies overlap by {depth:.3g} m",
                    "move them apart, or the robot jumps",
                )
            )
        for index in range(model.njnt):
            if (
                key < 0
                or not model.jnt_limited[index]
                or int(model.jnt_type[index]) == int(mujoco.mjtJoint.mjJNT_BALL)
            ):
                continue
            value, (low, high) = float(data.qpos[model.jnt_qposadr[index]]), model.jnt_range[index]
            if not low - 1e-9 <= value <= high + 1e-9:
                name = model.joint(index).name
                findings.append(
                    Finding(
                        "warning",
                        place,
                        f"joint {name} is at {value:.4g}, outside {low:.4g} .. {high:.4g}",
                        "move it inside its range",
                    )
                )
    return findings
