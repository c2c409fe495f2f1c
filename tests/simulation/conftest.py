"""Shared: small environments and the design, made once."""

import dataclasses

import pytest

from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.settings import Limits, Physics, Start
from hyperleg_design.simulation.tasks import load_task

STILL = Start(joint_position=0, tilt=0, yaw=0)


@pytest.fixture(scope="session")
def design():
    return load_design()


@pytest.fixture
def make(design):
    """An environment; keywords beside the environment's own change the task's sections."""

    def made(task="walk", simulations=4, seed=0, robot=None, **changes):
        own = {k: changes.pop(k) for k in ("threads", "assist") if k in changes}
        chosen = load_task(task)
        commands = changes.pop("commands", {})
        chosen = chosen.changed(
            commands=dataclasses.replace(chosen.commands, **commands), **changes
        )
        return Environment(robot or design, chosen, simulations=simulations, seed=seed, **own)

    return made


@pytest.fixture
def finely(make):
    """An environment at another time step, started upright, that hardly anything ends."""

    def made(time_step, simulations=1, robot=None, **physics):
        settings = Physics(time_step=time_step, substeps=round(0.02 / time_step), **physics)
        return make(
            simulations=simulations,
            robot=robot,
            physics=settings,
            start=STILL,
            limits=Limits(height=0.1, tilt=3.0),
        )

    return made
