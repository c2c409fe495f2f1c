import diagnosed
import pytest


@pytest.fixture(scope="session")
def viscous(robot_files):
    """Diagnosis of a rig with more viscous friction at the knee."""
    return diagnosed.diagnosis(robot_files, "viscous")
