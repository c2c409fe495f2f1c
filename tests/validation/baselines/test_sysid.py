import pytest

from hyperleg_design.validation.baselines.own import fit_own
from hyperleg_design.validation.baselines.sysid import fit_sysid


@pytest.mark.slow
def test_sysid_finds_it_too_with_a_simulation_a_parameter(rig):
    pytest.importorskip(
        "mujoco.sysid._src.optimize", reason="needs mujoco[sysid]: the extra baselines"
    )
    found = fit_sysid(rig.signals[:2], rig.drives)
    own = fit_own(rig.signals[:2], rig.drives)
    assert rig.held_out(found.values) < 0.25 * rig.held_out(0 * found.values)
    assert rig.held_out(own.values) < 1.3 * rig.held_out(found.values)
    assert found.evaluations > 3 * own.evaluations
