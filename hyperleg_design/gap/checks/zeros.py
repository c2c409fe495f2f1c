"""Whether encoders seem to be set to zero as a log begins."""

from __future__ import annotations

from collections.abc import Iterator

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.joint_units import unit_at
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.results.finding import NOTE, Finding
from hyperleg_design.gap.signals.zeroing import zero_spread


def zeroed(log: Log, subject: Subject) -> Iterator[Finding]:
    """Say that encoders count from where their joints hung, and how uncertain that is.

    Args:
        log: as it was read.
        subject: the robot.

    Yields:
        One note, of a log whose zeros are uncertain.
    """
    spread = dict(zip(subject.joints, zero_spread(log, subject).tolist(), strict=True))
    if any(spread.values()):
        usual = ", ".join(
            f"{joint} {size:.2g} {unit_at(subject, 'joint', joint, 'rad')}"
            for joint, size in spread.items()
        )
        text = (
            "starts at 0 where the joints hang: the encoders seem to be set to zero there, which "
            f"dry friction makes uncertain ({usual})"
        )
        remedy = "offsets of this size count as usual; set zeros at a stop or a mark"
        yield Finding(NOTE, "position", text, remedy)
