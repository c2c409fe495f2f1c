"""Models of the simulations of one batch: of a design each, or varied at random."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.simulation.stepping.streams import RowStreams
from hyperleg_design.simulation.tasks import Task

if TYPE_CHECKING:
    import mujoco


def give_models(batch: Any, models: Sequence[mujoco.MjModel]) -> None:
    """Give each simulation the values of a model of its own.

    Args:
        batch: MuJoCo's batch, which is changed.
        models: of the simulations; all are compiled from designs with the same structure.
    """
    from mujoco.batch import MODEL_FIELDS

    distinct = {id(model): model for model in models}
    place = {key: i for i, key in enumerate(distinct)}
    rows = [place[id(model)] for model in models]
    for name in sorted(MODEL_FIELDS):
        values = [_field(model, name) for model in distinct.values()]
        if all(np.array_equal(values[0], v) for v in values[1:]):
            continue
        own = batch.expand(name)
        # MuJoCo shares what lies past a field's first rows, such as bounding volumes of meshes
        wanted = np.stack(values)
        own[:] = (wanted if wanted.ndim < 2 else wanted[:, : own.shape[1]])[rows].reshape(own.shape)


def _field(model: mujoco.MjModel, name: str) -> Any:
    place, _, option = name.partition(".")
    return np.asarray(getattr(getattr(model, place), option) if option else getattr(model, name))


def vary_models(batch: Any, task: Task, rng: RowStreams) -> None:
    """Vary masses and floor friction of each simulation at random.

    Args:
        batch: MuJoCo's batch, which is changed.
        task: states how much they vary.
        rng: random numbers of the simulations.
    """
    settings = task.randomisation
    if settings.mass:
        factor = rng.uniform(1 - settings.mass, 1 + settings.mass, (batch.nsim, batch.model.nbody))
        batch.expand("body_mass")[:] *= factor
        batch.expand("body_inertia")[:] *= factor[..., None]
    if settings.floor_friction:
        batch.expand("geom_friction")[..., 0] *= rng.uniform(
            1 - settings.floor_friction, 1 + settings.floor_friction, (batch.nsim, 1)
        )
    if settings.mass:
        batch.set_const()
