"""Diagnose the gap between logs and a robot's model: where it lies, which effects cause it, how far
it shrinks with them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from hyperleg_design.errors import InputError
from hyperleg_design.gap.checks.check import Check
from hyperleg_design.gap.checks.intake import Intake, prepare
from hyperleg_design.gap.inference.detectors.sinking import EFFECT as SOFT
from hyperleg_design.gap.inference.detectors.sinking import sinks
from hyperleg_design.gap.inference.detectors.slipping import EFFECT as SLIPPERY
from hyperleg_design.gap.inference.detectors.slipping import slips
from hyperleg_design.gap.inference.effect_traces import places
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.pipeline.detected_causes import misplaced_feet, of_feet
from hyperleg_design.gap.pipeline.judge import judge_signals
from hyperleg_design.gap.results.diagnosis import Diagnosis
from hyperleg_design.gap.signals.signals import Signals


def diagnose(
    robot: str | Path | None,
    logs: Sequence[Log],
    reference: Sequence[Log] = (),
    *,
    reference_robot: str | Path | None = None,
    seed: int = 0,
    threads: int = 2,
    show: Callable[[str], None] | None = None,
    rules: InferenceRules | None = None,
) -> Diagnosis:
    """Diagnose logs of a robot.

    Args:
        robot: a design of ours, an MJCF or a URDF file; none: what the logs name.
        logs: to be diagnosed; those whose metadata call them references count as such.
        reference: of the same robot when all was well.
        reference_robot: nominal model of the robot in the reference logs, where it was built
            differently then; by default the same as now. Joints and motors must be the same.
        seed: of the bootstrap; the same logs and seed give the same diagnosis.
        threads: that share the work; they change no result.
        show: takes lines of progress.
        rules: numbers that the inference decides by; the usual ones by default.

    Returns:
        The diagnosis.

    Raises:
        InputError: no log to diagnose, a log that is not fit for it, or one that does not go with
            the robot.
    """
    intake = prepare(robot, logs, reference, reference_robot=reference_robot)
    return diagnose_intake(intake, seed=seed, threads=threads, show=show, rules=rules)


def diagnose_intake(
    intake: Intake,
    *,
    seed: int = 0,
    threads: int = 2,
    show: Callable[[str], None] | None = None,
    rules: InferenceRules | None = None,
) -> Diagnosis:
    """Diagnose logs that are checked and conditioned, as `diagnose` does.

    Args:
        intake: the logs and their robot.
        seed: of the bootstrap.
        threads: that share the work.
        show: takes lines of progress.
        rules: numbers that the inference decides by; the usual ones by default.

    Returns:
        The diagnosis.

    Raises:
        InputError: no log has a residual.
    """
    if show is not None:
        show(f"comparing {len(intake.checks)} logs with the model of {intake.subject.name}")
    return diagnose_signals(
        intake.tests,
        intake.references,
        seed=seed,
        threads=threads,
        show=show,
        checks=intake.checks,
        rules=rules,
    )


def diagnose_signals(
    signals: Sequence[Signals],
    references: Sequence[Signals] = (),
    *,
    seed: int = 0,
    threads: int = 2,
    show: Callable[[str], None] | None = None,
    checks: Sequence[Check] = (),
    effects: Sequence[str] | None = None,
    rules: InferenceRules | None = None,
) -> Diagnosis:
    """Diagnose conditioned logs, as `diagnose` does.

    Args:
        signals: of the logs to be diagnosed.
        references: of logs of the healthy robot.
        seed: of the bootstrap.
        threads: that share the work.
        show: takes lines of progress.
        checks: of the logs, for remarks and doubts.
        effects: of the catalogue that are tried; all by default.
        rules: numbers that the inference decides by; the usual ones by default.

    Returns:
        The diagnosis.

    Raises:
        InputError: no log, or none with a residual.
    """
    say = show or (lambda _: None)
    if not signals:
        raise InputError("diagnose", "logs", None, "are missing: give at least one log")
    rules = rules or InferenceRules()
    say("trying every effect of the catalogue on what the model leaves over")
    diagnosis = judge_signals(
        signals,
        references,
        [
            place
            for place in places(signals[0].subject, effects)
            if place[0] not in (SLIPPERY, SOFT)  # feet tell these by themselves, see `_beside`
        ],
        rules,
        seed=seed,
        threads=threads,
        checks=checks,
        show=show,
    )
    return _beside(diagnosis, signals, references, effects, rules)


def _beside(
    diagnosis: Diagnosis,
    signals: Sequence[Signals],
    references: Sequence[Signals],
    effects: Sequence[str] | None,
    rules: InferenceRules,
) -> Diagnosis:
    """Add slippery or soft ground to a diagnosis, where it explains at least `main_part` of the
    error on logs, or halves of one, from which it was not estimated. Where an encoder of a leg is
    named, nobody knows how its foot moves.
    """
    least, certain = rules.posterior.main_part, rules.posterior.highest(bool(references))
    misplaced = misplaced_feet(diagnosis, signals[0].subject)
    for effect, tell in ((SLIPPERY, slips), (SOFT, sinks)):
        if effects is None or effect in effects:
            grounds = tell(signals, references, rules.ground)
            foretold = tuple(
                ground
                for ground in grounds
                if ground.closed >= least and ground.foot not in misplaced
            )
            diagnosis = of_feet(diagnosis, foretold, certain, rules.posterior.remainder)
    return diagnosis
