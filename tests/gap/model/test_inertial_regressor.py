import numpy as np
from random_motion import TICKS, random_motion

from hyperleg_design.gap.model import inertial_regressor, rigid


def test_regressors_of_all_links_give_the_torque(subject):
    q, v, a, base = random_motion(subject, 1)
    torque, wrench = np.zeros(q.shape), np.zeros((TICKS, 6))
    for link, parameters in zip(subject.links, subject.tree.link_inertial, strict=True):
        rows, of_base = inertial_regressor.regressors(subject, q, v, a, base, link)
        torque += rows @ parameters
        wrench += of_base @ parameters
    np.testing.assert_allclose(
        torque, rigid.inverse_dynamics(subject, q, v, a, base, rotors=False), atol=1e-9
    )
    if base is not None:
        np.testing.assert_allclose(wrench, rigid.base_wrench(subject, q, v, a, base), atol=1e-9)
