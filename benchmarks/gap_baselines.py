"""Time of parameter fits to the same held-out error: ours beside `mujoco.sysid` (Gauss-Newton) and
PACE's CMA-ES.

Logs come from the blind trials' rig plant (its own rigid-body code) with friction added at one
joint. All three fit PACE's parameters to two logs; the error is the RMS position error of a replay
of a third. A method's time is when its best values first come within `SLACK` of our error; one that
never does counts with all its time, as a lower bound. Ratios are of medians within this run.
"""

from __future__ import annotations

import os
import statistics
import tempfile
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.validation.baselines.drive_set import DriveSet, Fitted, drive_set
from hyperleg_design.validation.baselines.own import fit_own
from hyperleg_design.validation.baselines.pace import fit_pace
from hyperleg_design.validation.baselines.population import position_gap
from hyperleg_design.validation.baselines.sysid import fit_sysid
from hyperleg_design.validation.blind.plan import Plan
from hyperleg_design.validation.blind.recorder import Recorder
from hyperleg_design.validation.blind.rig_case import rig_case

TARGETS = {"sysid": 5.0, "pace": 50.0}
SLACK = 1.05
REPEATS = {"own": 5, "sysid": 3, "pace": 1}
ROBOTS = ("servo", "arm")


def logs_of(robot: str) -> tuple[list[Signals], list[Signals], DriveSet]:
    recorder = Recorder(
        rate=200.0, jitter=1e-4, dropped=0.0, torque="none", velocity=True, drives=False
    )
    case = rig_case(
        Plan(
            index=0,
            kind="single",
            plant="rig",
            robot=robot,
            effects=("coulomb_friction",),
            multiples=(4.0,),
            references=False,
            recorder=recorder,
            duration=10.0,
            seed=(90210, 0),
        )
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "robot.xml"
        path.write_text(case.mjcf or "")
        subject = load_subject(str(path), case.logs)
        signals = [condition(log, subject) for log in case.logs]
    return signals[:2], signals[2:], drive_set(signals[0].subject, signals[0].step)


def reached(
    found: Fitted, held: list[Signals], drives: DriveSet, goal: float
) -> tuple[float, bool]:
    """When the method's best values first reached an error, and whether they did."""
    for seconds, values in found.history:
        if float(position_gap(held, drives, values)[0]) <= goal:
            return seconds, True
    return found.seconds, False


def main() -> None:
    for robot in ROBOTS:
        train, held, drives = logs_of(robot)
        own = [fit_own(train, drives) for _ in range(REPEATS["own"])]
        error = float(position_gap(held, drives, own[0].values)[0])
        goal = SLACK * error
        base = statistics.median(reached(one, held, drives, goal)[0] for one in own)
        before = float(position_gap(held, drives, 0 * own[0].values)[0])
        print(f"{robot}: {drives.count} parameters, held-out error {1e3 * before:.2f} mrad before")
        print(f"  own    {base:8.2f} s  {1e3 * error:.2f} mrad")
        budget = 1.5 * TARGETS["pace"] * statistics.median(one.seconds for one in own)
        fits = {
            "sysid": lambda: fit_sysid(train, drives, seconds=budget),  # noqa: B023
            "pace": lambda: fit_pace(train, drives, seconds=budget),  # noqa: B023
        }
        for name, fit in fits.items():
            found = [fit() for _ in range(REPEATS[name])]
            times = [reached(one, held, drives, goal) for one in found]
            median, all_reached = statistics.median(t for t, _ in times), all(r for _, r in times)
            after = float(position_gap(held, drives, found[0].values)[0])
            ratio = median / base
            mark = "reached" if ratio >= TARGETS[name] else "missed"
            at_least = "" if all_reached else "at least "
            print(
                f"  {name:<6} {median:8.2f} s  {1e3 * after:.2f} mrad  {at_least}{ratio:.0f} times "
                f"ours; target {TARGETS[name]:g}: {mark}"
            )


if __name__ == "__main__":
    main()
