"""Design, size, simulate and compare legged robots with cooperative actuation.

Heavy libraries load when a function that needs them is called.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.2.0.dev0"

_HOME = {
    "HyperlegError": "errors",
    "InputError": "errors",
    "OutputError": "errors",
    "InfeasibleError": "errors",
    "Design": "robot.design",
    "load_design": "robot.design",
    "load_robot": "robot.load",
    "import_robot": "robot.importing",
    "ablate": "robot.ablation",
    "variants": "robot.ablation",
    "confound": "robot.ablation",
    "Motor": "robot.motors",
    "catalogue": "robot.motors",
    "find_motor": "robot.motors",
    "mass_table": "robot.masses",
    "joint_from_motor": "robot.transmission",
    "max_joint_torque": "robot.transmission",
    "single_joint_speed": "robot.transmission",
    "LinkageModel": "robot.linkage",
    "urdf": "robot.description",
    "mjcf": "robot.mjcf",
    "mujoco_model": "robot.mjcf",
    "mujoco_spec": "robot.mjcf",
    "rigid_body_model": "robot.models",
    "build": "robot.build",
    "check_file": "robot.check",
    "analyze": "sizing.analysis",
    "motor_envelope": "sizing.envelope",
    "torque_limits": "sizing.envelope",
    "trajectory_margin": "sizing.margin",
    "slice_polygon": "sizing.slices",
    "energy_ledger": "sizing.energy",
    "thermal_use": "sizing.thermal",
    "leg_inertia": "sizing.inertia",
    "demand": "sizing.demand",
    "load_sweep": "sweep.space",
    "run_sweep": "sweep.run",
    "nondominated": "sweep.pareto",
}
"""Module that each public name comes from."""

if TYPE_CHECKING:
    from hyperleg_design.errors import HyperlegError as HyperlegError
    from hyperleg_design.errors import InfeasibleError as InfeasibleError
    from hyperleg_design.errors import InputError as InputError
    from hyperleg_design.errors import OutputError as OutputError
    from hyperleg_design.robot.ablation import ablate as ablate
    from hyperleg_design.robot.ablation import confound as confound
    from hyperleg_design.robot.ablation import variants as variants
    from hyperleg_design.robot.build import build as build
    from hyperleg_design.robot.check import check_file as check_file
    from hyperleg_design.robot.description import urdf as urdf
    from hyperleg_design.robot.design import Design as Design
    from hyperleg_design.robot.design import load_design as load_design
    from hyperleg_design.robot.importing import import_robot as import_robot
    from hyperleg_design.robot.linkage import LinkageModel as LinkageModel
    from hyperleg_design.robot.load import load_robot as load_robot
    from hyperleg_design.robot.masses import mass_table as mass_table
    from hyperleg_design.robot.mjcf import mjcf as mjcf
    from hyperleg_design.robot.mjcf import mujoco_model as mujoco_model
    from hyperleg_design.robot.mjcf import mujoco_spec as mujoco_spec
    from hyperleg_design.robot.models import rigid_body_model as rigid_body_model
    from hyperleg_design.robot.motors import Motor as Motor
    from hyperleg_design.robot.motors import catalogue as catalogue
    from hyperleg_design.robot.motors import find_motor as find_motor
    from hyperleg_design.robot.transmission import joint_from_motor as joint_from_motor
    from hyperleg_design.robot.transmission import max_joint_torque as max_joint_torque
    from hyperleg_design.robot.transmission import single_joint_speed as single_joint_speed
    from hyperleg_design.sizing.analysis import analyze as analyze
    from hyperleg_design.sizing.demand import demand as demand
    from hyperleg_design.sizing.energy import energy_ledger as energy_ledger
    from hyperleg_design.sizing.envelope import motor_envelope as motor_envelope
    from hyperleg_design.sizing.envelope import torque_limits as torque_limits
    from hyperleg_design.sizing.inertia import leg_inertia as leg_inertia
    from hyperleg_design.sizing.margin import trajectory_margin as trajectory_margin
    from hyperleg_design.sizing.slices import slice_polygon as slice_polygon
    from hyperleg_design.sizing.thermal import thermal_use as thermal_use
    from hyperleg_design.sweep.pareto import nondominated as nondominated
    from hyperleg_design.sweep.run import run_sweep as run_sweep
    from hyperleg_design.sweep.space import load_sweep as load_sweep

__all__ = ["__version__", *_HOME]


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    # import_module by full path: `mjcf` is both a module and a function in it
    value = getattr(importlib.import_module(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
