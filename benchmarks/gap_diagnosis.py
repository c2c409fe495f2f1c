"""What a diagnosis costs: time and memory of a single servo, and of all 14 joints with 60 s of logs
at 200 Hz; time over log length.

Logs come from the blind trials' rig plant, with friction added at one joint. Each diagnosis runs in
a process of its own, on two threads, and tells its own peak memory and the time that it took: of
all processors, which says little of what else the computer does, and on the clock. Targets on two
idle cores: servo 3 s, 14 joints 75 s, 2.5 GiB; time linear in length.

Run: python benchmarks/gap_diagnosis.py
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from hyperleg_design.gap.logs.log import write_log
from hyperleg_design.validation.blind.plan import Plan
from hyperleg_design.validation.blind.recorder import Recorder
from hyperleg_design.validation.blind.rig_case import rig_case

TARGETS = {"servo": 3.0, "hyperleg": 75.0}
MEMORY = 2.5
"""GiB"""
LENGTHS = (8.0, 16.0, 32.0)
"""Of each of the three logs of the arm [s]."""
CHILD = """
import json, resource, sys, time
from pathlib import Path
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.logs.log import read_log
folder = Path(sys.argv[1])
logs = [read_log(p) for p in sorted(folder.glob("*.parquet"))]
begun, worked = time.perf_counter(), time.process_time()
found = diagnose(sys.argv[2], logs, threads=2)
print(json.dumps({"seconds": time.perf_counter() - begun, "processor": time.process_time() - worked,
                  "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
                  "verdict": found.verdict, "causes": [f"{c.effect} at {c.location}" for c in found.causes]}))
"""  # noqa: E501


def logs_of(robot: str, seconds: float, folder: Path) -> str:
    """Write three logs of a robot with added friction; the robot for the diagnosis."""
    recorder = Recorder(
        rate=200.0, jitter=1e-4, dropped=0.0, torque="motor_current", velocity=True, drives=False
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
            duration=seconds,
            seed=(90211, 0),
        ),
    )
    folder.mkdir(parents=True)
    for number, log in enumerate(case.logs):
        write_log(folder / f"{number}.parquet", log)
    if case.mjcf is None:
        return case.robot
    (folder / case.robot).write_text(case.mjcf)
    return str(folder / case.robot)


def cost(folder: Path, robot: str) -> dict[str, object]:
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-c", CHILD, str(folder), robot],
        check=True,
        capture_output=True,
        text=True,
        env=environment,
    )
    found: dict[str, object] = json.loads(done.stdout.splitlines()[-1])
    return found


def main() -> None:
    with tempfile.TemporaryDirectory() as place:
        for robot, seconds in (("servo", 20.0), ("hyperleg", 20.0)):
            folder = Path(place) / robot
            found = cost(folder, logs_of(robot, seconds, folder))
            target = f"target {TARGETS[robot]:.0f} s, {MEMORY:.1f} GiB"
            print(
                f"{robot}: 3 logs of {seconds:.0f} s: {found['processor']:.1f} s of processors, "
                f"{found['seconds']:.1f} s on the clock, {found['memory']:.2f} GiB ({target}); "
                f"{found['verdict']}"
            )
        times = []
        for seconds in LENGTHS:
            folder = Path(place) / f"arm_{seconds:.0f}"
            times.append(float(str(cost(folder, logs_of("arm", seconds, folder))["processor"])))
        ratios = ", ".join(
            f"{t / times[0]:.2f} at {s / LENGTHS[0]:.0f} x"
            for s, t in zip(LENGTHS, times, strict=True)
        )
        print(
            f"arm: processor time over that of logs of {LENGTHS[0]:.0f} s: {ratios} the length "
            f"(linear: the same)"
        )


if __name__ == "__main__":
    main()
