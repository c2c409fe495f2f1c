import diagnosed
import numpy as np
import robots
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect

GAIN = effect("controller_gain")


def test_trace_is_what_other_gains_leave(pendulum):
    for sees, residual_name in ((("motor_torque",), "drive"), ((), "motion")):
        signals = pendulum(Wrong(stiffness_scale=0.8, damping_scale=1.3), sees=sees)
        trace = GAIN.trace(signals, "swing", np.array([[0.8, 1.3]]))
        assert set(trace) == {residual_name}
        assert misfit(signals, trace, residual_name) < 0.01


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("controller_gain", [0.8, 1.2])
    assert misfit(signals, GAIN.trace(signals, "swing", np.array([[0.8, 1.2]])), "drive") < 0.03


def test_measured_torques_show_it_whatever_the_controllers_sensors_saw(robot_files):
    """A velocity that no position follows, as of a shaking joint that is sampled too slowly, damps
    all the same.
    """
    log = robots.without(
        robots.without(robots.geared_run("joint", ("hip", "knee")), "motor_velocity"),
        "motor_torque_command",
    )
    shaken = np.abs(log.time - 4.0) < 0.2
    false = log.column("velocity/hip") + 2.0 * shaken
    (stiffness, damping), (soft, dull) = robots.GAINS[0], (0.8, 1.3)
    asked = (
        soft * stiffness * (log.column("position_target/hip") - log.column("position/hip"))
        - dull * damping * false
    )
    told = {"velocity/hip": false, "motor_torque/hip": asked}
    signals = diagnosed.conditioned(
        robot_files["geared"], log.changed(signals={**log.signals, **told})
    )[0]
    trace = GAIN.trace(signals, "hip", np.array([[soft, dull]]))["drive"][0, :, 0]
    left = np.abs(trace - signals.residual["drive"][:, 0])[
        signals.valid & (np.abs(signals.time - 4.0) < 0.15)
    ]
    assert left.max() < 0.1 * (dull - 1) * damping * 2.0


def test_of_logged_commands_it_shows_in_the_control(pendulum):
    signals = pendulum(
        Wrong(stiffness_scale=0.8, damping_scale=1.3), sees=("motor_torque", "motor_torque_command")
    )
    trace = GAIN.trace(signals, "swing", np.array([[0.8, 1.3]]))
    assert set(trace) == {"control"}
    assert misfit(signals, trace, "control") < 0.01
    assert np.nanmax(np.abs(signals.residual["drive"])) < 1e-9


def test_joints_without_gains_cannot_have_it():
    from hyperleg_design.gap.signals.loading import load_subject

    subject = load_subject("hyperleg")
    assert GAIN.locations(subject) == subject.joints
