"""Joints that a limit cycle unsettles."""

from types import SimpleNamespace

import numpy as np


def test_what_chattered_before_is_no_news():
    from dataclasses import dataclass

    from hyperleg_design.gap.inference.detectors.unsettled import newly
    from hyperleg_design.gap.signals.limit_cycle import LimitCycle

    @dataclass(frozen=True, eq=False)
    class Shown:
        limit_cycle: LimitCycle | None

    def log(*joints):
        return Shown(
            LimitCycle(np.ones((4, 2)), np.full(2, 50.0), np.full(2, 0.9), np.array(joints, bool))
        )

    tests, references = [log(1, 1), Shown(None)], [log(1, 0), Shown(None)]
    assert newly(tests, references)[0].limit_cycle.joints.tolist() == [False, True]
    assert newly(tests, [Shown(None)])[0].limit_cycle.joints.tolist() == [True, True]


def test_joints_of_all_logs_are_told():
    from hyperleg_design.gap.inference.detectors.unsettled import unsettled

    def filtered_log(*joints):
        shaken = SimpleNamespace(joints=np.array(joints, bool)) if joints else None
        return SimpleNamespace(
            signals=SimpleNamespace(
                limit_cycle=shaken, subject=SimpleNamespace(joints=("hip", "knee"))
            )
        )

    assert unsettled(SimpleNamespace(filtered_logs=[filtered_log(), filtered_log(0, 1)])) == (
        "knee",
    )
    assert unsettled(SimpleNamespace(filtered_logs=[filtered_log()])) == ()


def test_joints_that_are_shaken_along_are_not_to_blame():
    from hyperleg_design.gap.inference.detectors.unsettled import MOVED, shaking, unsettled

    def filtered_log(speed, *joints):
        swing = (
            None
            if speed is None
            else SimpleNamespace(
                joints=np.array(joints, bool), speed=np.broadcast_to(np.array(speed, float), (5, 3))
            )
        )
        return SimpleNamespace(
            signals=SimpleNamespace(
                limit_cycle=swing, subject=SimpleNamespace(joints=("hip", "knee", "toe"))
            )
        )

    logs = SimpleNamespace(
        filtered_logs=[filtered_log(None), filtered_log([0.9 * MOVED, 1.1 * MOVED, 1.0], 1, 1, 1)]
    )
    assert unsettled(logs) == ("hip", "knee", "toe")
    assert shaking(logs) == ("knee", "toe")
    logs.filtered_logs.append(filtered_log([0.1, 9.0, 0.0], 1, 0, 0))
    assert shaking(logs) == ("hip", "knee", "toe"), (
        "it is loudest in one log; what does not chatter there is not"
    )
    assert shaking(SimpleNamespace(filtered_logs=[filtered_log(None)])) == ()
