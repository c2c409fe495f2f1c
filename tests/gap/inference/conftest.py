import diagnosed
import pytest

from hyperleg_design.gap.inference.hypotheses.search import Search
from hyperleg_design.gap.inference.nuisance import nuisance_parameters
from hyperleg_design.gap.inference.rules import InferenceRules


@pytest.fixture(scope="session")
def search(robot_files):
    """Search for friction of a robot with viscous friction at its knee, dry friction at its hip."""
    evidence = diagnosed.evidence(robot_files["coupled"], diagnosed.run("both", 0))
    places = [
        (effect, joint)
        for effect in ("viscous_friction", "coulomb_friction")
        for joint in ("hip", "knee")
    ]
    return Search(evidence, InferenceRules(), places)


@pytest.fixture(scope="session")
def viscous(robot_files):
    """Evidence of a robot with viscous friction at its knee, with one log of it as a reference."""
    return diagnosed.evidence(
        robot_files["coupled"],
        diagnosed.run("viscous", 0),
        references=(diagnosed.run("viscous", 1, role="reference"),),
    )


@pytest.fixture(scope="module")
def errors(signals):
    """Nuisance parameters of that robot."""
    return nuisance_parameters(signals.subject, signals.step)
