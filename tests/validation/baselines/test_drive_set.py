import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.validation.baselines.drive_set import drive_set
from hyperleg_design.validation.baselines.own import fit_own
from hyperleg_design.validation.baselines.pace import fit_pace
from hyperleg_design.validation.baselines.sysid import fit_sysid


def test_cause_is_the_largest_change_over_its_usual_error(rig):
    values = np.zeros(rig.drives.count)
    values[2], values[3] = 5 * rig.drives.spread[2], -2 * rig.drives.spread[3]
    assert rig.drives.cause(values) == ("coulomb_friction", "swing", pytest.approx(5.0))
    values[-1] = 20 * rig.drives.spread[-1]
    assert rig.drives.cause(values)[:2] == ("command_delay", "robot")


def test_logs_without_targets_and_floating_bases_are_refused(rig):
    bare = rig.logs[0].changed(
        signals={
            c: v for c, v in rig.logs[0].signals.items() if not c.startswith("position_target")
        }
    )
    torques = {"motor_torque/swing": np.zeros(len(bare.time))}
    signals = condition(bare.changed(signals={**bare.signals, **torques}), rig.signals[0].subject)
    for fit in (fit_own, fit_pace, fit_sysid):
        with pytest.raises(InputError, match="targets and gains"):
            fit([signals], rig.drives)
    with pytest.raises(InputError, match="fixed base"):
        drive_set(load_subject("hyperleg"), 0.005)
