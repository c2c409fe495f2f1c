import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def pendulum(tmp_path_factory):
    """Signals of a pendulum with something wrong, from (wrong, **options) of `pendulum.run`."""
    from pendulum import conditioned

    folder = tmp_path_factory.mktemp("pendulum")
    kept = {}

    def signals(wrong, **options):
        key = (wrong, *sorted((name, repr(value)) for name, value in options.items()))
        if key not in kept:
            kept[key] = conditioned(folder, wrong, **options)
        return kept[key]

    return signals


@pytest.fixture(scope="session")
def simulated(pendulum):
    """Signals of a simulation of the pendulum to which an effect was added: (identifier, values,
    **options) of `altered.altered`.
    """
    from altered import altered
    from pendulum import Wrong, waves

    from hyperleg_design.gap.effects import effect

    subject = pendulum(Wrong()).subject

    def signals(identifier, values, *, target=waves, **options):
        one = effect(identifier)
        location = one.locations(subject)[0]
        added = (
            (one.alteration(location, np.array(values, float), subject),)
            if values is not None
            else ()
        )
        return altered(subject, added, lambda time: [target(time)], **options)

    return signals


@pytest.fixture(scope="session")
def leg(tmp_path_factory):
    """Signals of a coupled leg of two joints that two motors move together, on targets."""
    import robots
    from altered import altered

    from hyperleg_design.gap.logs.log import Log
    from hyperleg_design.gap.logs.metadata import Metadata
    from hyperleg_design.gap.signals.loading import load_subject

    path = tmp_path_factory.mktemp("leg") / "leg.xml"
    path.write_text(robots.COUPLED)
    gains = {"hip": (40.0, 2.0), "knee": (30.0, 1.5)}
    blank = Log(
        "leg",
        np.array([0.0, 1.0]),
        {f"position/{j}": np.zeros(2) for j in gains},
        Metadata(base="fixed", gains=gains),
    )
    subject = load_subject(path, [blank])
    target = robots.waves(2, [0.6, 0.6], 0.3, 1.5)

    def signals(*alterations, **options):
        return altered(subject, alterations, target, **options)

    return signals
