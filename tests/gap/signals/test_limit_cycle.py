import numpy as np
import pytest

from hyperleg_design.gap.signals.limit_cycle import limit_cycle
from hyperleg_design.gap.signals.smoothing import smooth

STEP = 0.005
TIME = np.arange(2400) * STEP


def moved(swing, frequency, noise=2e-4, seed=0):
    """Positions and speeds of a joint that follows a slow wave and swings by an angle [rad] at a
    frequency [Hz].
    """
    rng = np.random.default_rng(seed)
    slow, fast = 2 * np.pi * 0.7, 2 * np.pi * frequency
    position = (
        0.4 * np.sin(slow * TIME) + swing * np.sin(fast * TIME) + noise * rng.normal(size=len(TIME))
    )
    velocity = (
        0.4 * slow * np.cos(slow * TIME)
        + swing * fast * np.cos(fast * TIME)
        + 0.02 * rng.normal(size=len(TIME))
    )
    return position[:, None], velocity[:, None]


def found(swing, frequency, logged=True, **options):
    position, velocity = moved(swing, frequency, **options)
    velocity = velocity if logged else np.full_like(velocity, np.nan)
    return limit_cycle(position, velocity, smooth(TIME, position, TIME, velocity), STEP)


@pytest.mark.parametrize("logged", [True, False])
@pytest.mark.parametrize("frequency", [48.0, 71.0])
def test_size_and_frequency_of_a_swing_are_found(frequency, logged):
    one = found(0.01, frequency, logged)
    assert one.joints[0]
    assert one.frequency[0] == pytest.approx(frequency, abs=1.0)
    speed = 0.01 * 2 * np.pi * frequency
    derived = (
        1.0 if logged else np.sinc(2 * frequency * STEP)
    )  # central differences see less of what is fast
    assert np.median(one.speed) == pytest.approx(
        derived * speed - 3e-4 * 2 * np.pi * frequency, rel=0.1
    )


@pytest.mark.parametrize("noise", [0.0, 2e-4, 3e-3])
def test_neither_noise_nor_a_swing_within_the_bristles_is_chatter(noise):
    assert found(0.0, 50.0, noise=noise) is None
    assert found(1e-4, 50.0, noise=1e-5) is None


def test_a_joint_in_a_limit_cycle_is_never_well_and_is_told(robot_files):
    import diagnosed

    from hyperleg_design.gap.pipeline.diagnose import diagnose

    def shaken(log, joint="knee", swing=0.01, fast=2 * np.pi * 70):
        signals = dict(log.signals)
        signals[f"position/{joint}"] = signals[f"position/{joint}"] + swing * np.sin(
            fast * log.time
        )
        signals[f"velocity/{joint}"] = signals[f"velocity/{joint}"] + swing * fast * np.cos(
            fast * log.time
        )
        return log.changed(signals=signals)

    found = diagnose(
        robot_files["coupled"],
        [shaken(diagnosed.run("healthy", s, session="a")) for s in (0, 1)],
        threads=1,
    )
    assert found.verdict == "unknown"
    assert {"shape": "limit cycle", "location": "knee"}.items() <= found.residual_shape[0].items()
    assert "70 Hz" in found.residual_shape[0]["says"]
    assert not found.causes
