import numpy as np
from pendulum import Wrong

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.effects.unlisted.inputs import INPUTS, functions

ODD = WEIGHED["odd_torque"]


def test_it_takes_the_functions_of_its_input(pendulum):
    signals = pendulum(Wrong())
    for number, name in enumerate(INPUTS):
        basis = functions(signals, 0, name)
        values = np.r_[np.arange(1.0, 1 + ODD.sizes), number]
        (found,) = ODD.trace(signals, "swing", values)["motion"]
        np.testing.assert_allclose(found[:, 0], values[: len(basis)] @ basis, atol=1e-12)


def test_its_usual_size_is_the_same_share_of_what_each_joint_is_made_for(leg):
    subject = leg(duration=1.5).subject
    sizes = [ODD.usual(joint, subject) for joint in subject.joints]
    for own in sizes:
        assert (own[: ODD.sizes] == own[0]).all()
        assert own[0] > 0
