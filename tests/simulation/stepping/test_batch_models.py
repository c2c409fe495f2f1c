"""Models of simulations that are stepped together."""

from __future__ import annotations

import numpy as np

from hyperleg_design.simulation.settings import Randomisation


def test_each_simulation_gets_the_numbers_of_its_own_robot(make, design):
    masses = np.array([0.2, 0.3, 0.4])
    environment = make(simulations=6, robot=design.with_values({"toe.mass": masses}))
    batch = environment.chunks[0].batch
    toe = environment.models[0].body("left_toe_plate").id
    own = np.asarray(batch.expand("body_mass"))[:, toe]
    wanted = [environment.models[i].body_mass[toe] for i in environment.design_index[: len(own)]]
    np.testing.assert_array_equal(own, wanted)
    assert len(set(own.tolist())) > 1


def test_masses_vary_within_their_share_and_inertias_with_them(make):
    environment = make(simulations=8, randomisation=Randomisation(mass=0.2, floor_friction=0.3))
    batch, model = environment.chunks[0].batch, environment.models[0]
    bodies = model.body_mass > 0
    ratio = np.asarray(batch.expand("body_mass"))[:, bodies] / model.body_mass[bodies]
    assert ratio.min() >= 0.8
    assert ratio.max() <= 1.2
    assert ratio.std() > 0.05
    inertia = np.asarray(batch.expand("body_inertia"))[:, bodies] / model.body_inertia[bodies]
    np.testing.assert_allclose(inertia, np.repeat(ratio[..., None], 3, -1))
    friction = np.asarray(batch.expand("geom_friction"))[..., 0] / model.geom_friction[:, 0]
    np.testing.assert_allclose(friction, np.repeat(friction[:, :1], friction.shape[1], 1))
    assert 0.7 <= friction.min() < friction.max() <= 1.3
