import numpy as np
import pytest
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect

DELAY = effect("command_delay")


def test_trace_is_what_late_commands_leave(pendulum):
    for sees, residual_name in ((("motor_torque",), "drive"), ((), "motion")):
        signals = pendulum(Wrong(delay=0.012), sees=sees)
        trace = DELAY.trace(signals, "robot", np.array([[0.012, 0.0]]))
        assert set(trace) == {residual_name}
        assert misfit(signals, trace, residual_name) < 0.02


def test_trace_is_what_late_targets_leave(pendulum):
    """In the drive, in the motion where nobody measured the drive, in the control where the
    controller's own commands are logged.
    """
    for sees, residual_name in (
        (("motor_torque",), "drive"),
        ((), "motion"),
        (("motor_torque", "motor_torque_command"), "control"),
    ):
        signals = pendulum(Wrong(late_target=0.012), sees=sees)
        trace = DELAY.trace(signals, "robot", np.array([[0.012, 1.0]]))
        assert misfit(signals, trace, residual_name) < 0.02
        others = [np.abs(rows).max() for name, rows in trace.items() if name != residual_name]
        assert max(others, default=0.0) == 0.0


@pytest.mark.slow
def test_simulation_with_late_targets_leaves_its_trace(simulated):
    signals, plain = simulated("command_delay", [0.012, 1.0]), simulated("command_delay", None)
    signals.residual["drive"][:] -= np.mean(plain.residual["drive"])
    assert misfit(signals, DELAY.trace(signals, "robot", np.array([[0.012, 1.0]])), "drive") < 0.2


def test_late_targets_of_coupled_motors_come_late_together(leg):
    signals = leg(duration=1.5)
    value = np.array([[0.01, 1.0]])
    assert np.abs(DELAY.trace(signals, "robot", value)["drive"]).max() > 0
    assert np.abs(DELAY.trace(signals, "m_front", value)["drive"]).max() == 0
    assert np.all(DELAY.starts(signals, "m_front")[:, 1] == 0)
    assert set(DELAY.starts(signals, "robot")[:, 1]) == {0.0, 1.0}


def test_simulation_with_it_leaves_its_trace(simulated):
    signals, plain = simulated("command_delay", [0.012, 0.0]), simulated("command_delay", None)
    # a simulation of steps of 1 ms is itself half a step late
    signals.residual["drive"][:] -= np.mean(plain.residual["drive"])
    assert misfit(signals, DELAY.trace(signals, "robot", np.array([[0.012, 0.0]])), "drive") < 0.2


def test_delays_between_simulation_steps_are_interpolated():
    from types import SimpleNamespace

    from hyperleg_design.gap.effects.drives.command_delay import LateCommand

    machine = SimpleNamespace(motor=lambda name: 0)
    late = LateCommand(("a",), (), np.array([0.0, 0.0025, 0.001]))
    live = late.live(late, machine, 3, 0.001)
    given = np.array([live.command(np.full((3, 1), float(step)), None)[:, 0] for step in range(10)])
    np.testing.assert_allclose(given[5:], np.arange(5, 10)[:, None] - np.array([0.0, 2.5, 1.0]))
    live.reset(np.arange(3), None, None)
    np.testing.assert_array_equal(live.command(np.full((3, 1), 7.0), None), 7.0)


def test_each_motor_of_several_can_be_late_alone(leg):
    signals = leg(duration=1.5)
    assert DELAY.locations(signals.subject) == ("robot", "m_front", "m_back")
    value = np.array([[0.01, 0.0]])
    alone = [DELAY.trace(signals, name, value)["drive"] for name in ("m_front", "m_back")]
    np.testing.assert_allclose(DELAY.trace(signals, "robot", value)["drive"], sum(alone))
    assert np.all(alone[0][..., 1] == 0)


def test_targets_and_commands_are_late_by_their_own():
    from types import SimpleNamespace

    from hyperleg_design.gap.effects.drives.command_delay import LateCommand

    machine = SimpleNamespace(motor=lambda name: 0, joint=lambda name: 0)
    late = LateCommand(("a",), ("q",), 0.0, np.array([0.002, 0.0]))
    live = late.live(late, machine, 2, 0.001)
    given = np.array([live.target(np.full((2, 1), float(step)), None)[:, 0] for step in range(6)])
    np.testing.assert_allclose(given[3:], np.arange(3, 6)[:, None] - np.array([2.0, 0.0]))
    np.testing.assert_array_equal(live.command(np.full((2, 1), 7.0), None), 7.0)


def test_one_drive_is_usually_as_late_as_all(leg):
    subject = leg(duration=1.5).subject
    (of_all,) = DELAY.nuisance_spreads(subject, 0.005).values()
    assert of_all[0] > 0
    for errors in DELAY.usual_errors(subject, 0.005).values():
        np.testing.assert_array_equal(errors, of_all)
    assert set(DELAY.usual_errors(subject, 0.005)) == set(DELAY.locations(subject))
