import diagnosed
import numpy as np

from hyperleg_design.gap.fit import Design
from hyperleg_design.gap.preparation import MOST_SESSIONS, sessions_of


def test_logs_without_a_session_are_sessions_of_their_own(robot_files):
    logs = [diagnosed.run("healthy", 0, session="a"), diagnosed.run("healthy", 1), diagnosed.run("healthy", 2, session="a")]
    signals = diagnosed.conditioned(robot_files["coupled"], *logs)
    assert sessions_of(signals).tolist() == [0, 1, 0]
    assert sessions_of(diagnosed.conditioned(robot_files["coupled"], *[logs[1]] * 6)).max() == MOST_SESSIONS - 1


def test_what_reference_logs_know_is_not_found_again(robot_files):
    healthy = [diagnosed.run("viscous", s, session="before", role="reference") for s in (2, 3)]
    test = diagnosed.run("viscous", 0, session="today")
    known = diagnosed.prepared(robot_files["coupled"], test, references=healthy)
    assert known.calibrated
    place = next(i for i, e in enumerate(known.errors) if (e.effect, e.location) == ("viscous_friction", "knee"))
    assert known.base.prior.mean[place] * known.errors[place].spread > 0.2
    fit = Design(known.base).fit()
    assert np.sqrt(np.mean(fit.rss / np.maximum(known.base.number.sum(0), 1e-9))) < 2
    alone = diagnosed.prepared(robot_files["coupled"], test)
    assert not alone.calibrated
    assert np.sum(Design(alone.base).fit().rss) > 10 * np.sum(fit.rss)
