import numpy as np
import pytest

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.signals.loading import load_subject


@pytest.mark.parametrize(
    ("mass", "declared", "beyond", "odds"),
    [
        (1.0, 0.0, 1, 0.0),
        (1.0, 0.0, 0, 2.0),
        (1.0, 0.0, 2, -3.0),
        (-1.0, 0.0, 1, -8.0),
        (-1.0, 2.0, 1, 0.0),
    ],
)
def test_loads_hang_at_the_ends_and_weigh_something(mass, declared, beyond, odds):
    values = np.array([mass, 0.0, 0.0, 0.0, 0.0])
    assert effect("payload").size_odds(values, np.ones(5), declared, beyond) == odds


def test_a_load_is_usual_up_to_the_error_of_the_mass_of_its_link(robot_files):
    subject = load_subject(str(robot_files["coupled"]), [])
    errors = effect("payload").usual_errors(subject, 0.005)
    masses = effect("link_mass").nuisance_spreads(subject, 0.005)
    assert set(masses) <= set(errors)
    for link, spread in masses.items():
        assert errors[link][0] == pytest.approx(spread[0])
        assert not errors[link][1:].any()
    assert effect("payload").nuisance_spreads(subject, 0.005) == {}


def test_a_load_hangs_anywhere_along_its_link(robot_files):
    subject = load_subject(str(robot_files["coupled"]), [])
    payload, tree = effect("payload"), subject.tree
    alike = [parameter.typical for parameter in payload.parameters[1:4]]
    reaches = []
    for link in payload.locations(subject):
        own = tree.link_inertial[tree.link(link)]
        centre = own[1:4] / own[0]
        usual = payload.usual(link, subject)[1:4]
        assert (usual >= np.maximum(alike, np.abs(centre))).all()
        assert (usual[centre == 0] == np.array(alike)[centre == 0]).all()
        reaches.append(np.abs(centre).max())
    assert max(reaches) > max(alike)  # so that a long link is among them
