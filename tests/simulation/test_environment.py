import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.ablation import variants
from hyperleg_design.simulation.environment import DIVERGENCES_KEPT
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.settings import Limits, Physics, Randomisation, Start
from hyperleg_design.simulation.terms.assist import Assist
from hyperleg_design.simulation.terms.terminations import DIVERGED, ENDINGS, TIME_OUT


def actions_of(environment, steps, seed=0, spread=0.5):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(steps, environment.simulations, environment.action_size)) * spread


def run(environment, actions):
    observations = environment.reset()
    rows = [observations["policy"]]
    for action in actions:
        step = environment.step(action)
        rows += [step.observations["policy"], step.reward, step.ending]
    environment.close()
    return rows


@pytest.mark.parametrize("task", ["walk", pytest.param("goal", marks=pytest.mark.slow)])
def test_same_seed_same_bytes_for_any_number_of_threads(make, task):
    found = []
    for threads in (1, 2, 3):
        environment = make(
            task,
            simulations=64,
            seed=7,
            threads=threads,
            randomisation=Randomisation(push_speed=0.5, push_interval=0.2),
        )
        found.append(run(environment, actions_of(environment, 45, spread=1.0)))
    for other in found[1:]:
        assert all(a.tobytes() == b.tobytes() for a, b in zip(found[0], other, strict=True))
    assert sum(np.count_nonzero(e) for e in found[0][3::3]) > 0  # with new starts within


def test_other_seeds_differ(make):
    one, other = (make(seed=s).reset()["policy"] for s in (1, 2))
    assert not np.allclose(one, other)


def test_a_simulation_does_not_feel_its_neighbours(make):
    """What one robot does changes nothing for another."""
    ends = []
    for scale in (0.0, 1.0):
        environment = make(simulations=4, seed=3)
        environment.reset()
        for action in actions_of(environment, 10):
            action[1:] *= scale
            step = environment.step(action)
        ends.append(step.observations["policy"])
    np.testing.assert_array_equal(ends[0][0], ends[1][0])
    assert not np.allclose(ends[0][1], ends[1][1])


def test_sizes_for_all_variants(make, design):
    for name, robot in variants(design).items():
        environment = make("walk_paper", robot=robot, simulations=2)
        observations = environment.reset()
        proprioception = 65 if name == "toe" else 57
        assert environment.action_size == (14 if name == "toe" else 12)
        assert environment.observation_sizes["policy"] == proprioception + 193
        assert observations["policy"].shape == (2, proprioception + 193)
        assert observations["policy"].dtype == np.float32
        assert len(environment.observation_columns["policy"]) == proprioception + 193
        step = environment.step(np.zeros((2, environment.action_size)))
        assert step.reward_terms.shape == (2, len(environment.reward_names))


def test_rewards_sum_to_the_reward(make):
    environment = make(simulations=8)
    environment.reset()
    for action in actions_of(environment, 30):
        step = environment.step(action)
        np.testing.assert_allclose(step.reward, step.reward_terms.sum(1))
        fell = step.reward_terms[:, environment.reward_names.index("termination")]
        np.testing.assert_allclose(fell, np.where(step.terminated, -200 * 0.02, 0.0))


def test_ended_episodes_start_anew(make):
    environment = make(simulations=8, start=Start(joint_position=0.05, tilt=0.0, yaw=0.0))
    environment.reset()
    ended = 0
    for action in actions_of(environment, 120, spread=1.0):
        before = environment.episode_step.copy()
        step = environment.step(action)
        for row, simulation in enumerate(step.ended):
            ended += 1
            assert step.terminated[simulation] or step.truncated[simulation]
            assert environment.episode_step[simulation] == 0
            assert step.episode_steps[row] == before[simulation] + 1
            last, first = (
                step.final_observations["policy"][row],
                step.observations["policy"][simulation],
            )
            assert abs(last[5]) < 0.9 or not np.allclose(last, first)
            np.testing.assert_allclose(first[3:6], [0, 0, -1], atol=1e-6)  # upright again
            assert np.all(first[-32:-2] == 0)  # no actions yet
        assert set(step.ended) == set(np.flatnonzero(step.terminated | step.truncated))
    assert ended > 3


def test_new_starts_stand_on_the_floor(make):
    environment = make(simulations=16, start=Start(joint_position=0.3, tilt=0.1))
    environment.reset()
    chunk = environment.chunks[0]
    chunk.batch.bind("geom_xpos")
    chunk.batch.forward()
    lowest = chunk.batch.geom_xpos[:, chunk.starter.pads, 2].min(1) - chunk.starter.pad_radius
    np.testing.assert_allclose(lowest, 0, atol=1e-12)


def test_episodes_time_out_without_counting_as_falls(make, design):
    stiff = {
        f"joints.{j}.stiffness": v
        for j, v in (
            ("hip_pitch", 800.0),
            ("knee", 800.0),
            ("ankle_pitch", 800.0),
            ("hip_roll", 300.0),
        )
    }
    environment = make(robot=design.with_values(stiff), simulations=2, limits=Limits(duration=0.2))
    environment.reset()
    steps = [environment.step(np.zeros((2, 14))) for _ in range(10)]
    assert not any(s.truncated.any() for s in steps[:-1])
    assert steps[-1].truncated.all()
    assert not steps[-1].terminated.any()
    assert np.all(steps[-1].ending == TIME_OUT)


def test_a_diverged_simulation_is_reported_and_left_out(make):
    environment = make(simulations=4)
    environment.reset()
    environment.step(np.zeros((4, 14)))
    environment.chunks[0].drive.qvel[2, 8] = np.nan
    step = environment.step(np.zeros((4, 14)))
    assert [d.simulation for d in step.divergences] == [2]
    assert step.ending.tolist() == [0, 0, DIVERGED, 0]
    assert ENDINGS[DIVERGED] == "diverged"
    assert step.reward[2] == 0
    assert step.truncated[2]
    assert not step.terminated[2]
    assert environment.divergences[0].episode_step == 2
    assert np.isnan(environment.divergences[0].velocity[8])
    assert np.all(np.isfinite(step.observations["critic"]))
    for _ in range(5):
        after = environment.step(np.zeros((4, 14)))
    assert not after.divergences
    assert environment.divergence_count == 1


def test_runaway_speed_counts_as_diverged_and_memory_is_bounded(make):
    environment = make(simulations=2)
    environment.reset()
    for _ in range(DIVERGENCES_KEPT + 5):
        environment.chunks[0].drive.qvel[1, 2] = 1e6
        environment.step(np.zeros((2, 14)))
    assert environment.divergence_count == DIVERGENCES_KEPT + 5
    assert len(environment.divergences) == DIVERGENCES_KEPT


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_actions_that_are_not_finite_are_one_clear_error(make, bad):
    environment = make(simulations=4)
    environment.reset()
    action = np.zeros((4, 14))
    action[2, 5] = bad
    with pytest.raises(InputError, match="not finite in 1 simulations, first in 2"):
        environment.step(action)
    assert np.all(environment.episode_step == 0)
    environment.step(np.zeros((4, 14)))


def test_actions_of_another_robot_are_refused(make):
    environment = make(simulations=4)
    environment.reset()
    with pytest.raises(InputError, match="another robot"):
        environment.step(np.zeros((4, 12)))


def test_a_design_that_cannot_stand_is_refused(make, design):
    with pytest.raises(InputError, match="lower than a fall"):
        make(robot=design.with_values({"thigh.length": 0.2, "shank.length": 0.2}))
    with pytest.raises(InputError, match="beside the soles"):
        make(robot=design.with_values({"joints.hip_pitch.default_deg": 30.0}))


def test_impossible_sizes_are_refused(make):
    with pytest.raises(InputError, match="at least 1"):
        make(simulations=0)
    with pytest.raises(InputError, match="threads"):
        make(threads=0)


def test_no_assist_unless_given_and_it_helps(make):
    assert make().assist is None
    survivors = []
    for assist in (None, Assist(1.0)):
        environment = make(
            simulations=4, assist=assist, commands={"test_share": 0.0, "standing_share": 1.0}
        )
        environment.reset()
        alive = np.ones(4, bool)
        for _ in range(200):
            step = environment.step(np.zeros((4, 14)))
            alive &= step.ending == 0
        survivors.append(alive.sum())
        assert np.all(environment.chunks[0].batch.xfrc_applied == 0)
    assert survivors == [0, 3]  # the first robot gets none of it


@pytest.mark.parametrize("friction", ["implicit", "explicit"])
def test_a_batch_of_designs_gives_each_simulation_its_own_robot(make, design, friction):
    values = {
        "pelvis.mass": [10.0, 15.46, 20.0],
        "joints.knee.stiffness": [120.0, 120.0, 60.0],
        "thigh.length": [0.36, 0.37, 0.40],
        "transmission.scale.knee": [0.8, 1.0, 1.2],
        "contact.friction": [0.5, 1.0, 0.8],
    }
    batch = design.with_values({path: np.array(v) for path, v in values.items()})
    settings = {
        "physics": Physics(friction=friction),
        "start": Start(joint_position=0, tilt=0, yaw=0),
    }
    together = make(robot=batch, simulations=3, **settings)
    together.reset()
    actions = actions_of(together, 8)
    for action in actions:
        together.step(action)
    for i in range(3):
        alone = make(robot=batch.take(i), simulations=1, **settings)
        alone.reset()
        for action in actions:
            alone.step(action[i : i + 1])
        np.testing.assert_allclose(
            together.chunks[0].drive.qpos[i], alone.chunks[0].drive.qpos[0], atol=1e-6
        )


def test_a_large_batch_of_designs_is_split(make, design):
    batch = design.with_values(
        {"pelvis.mass": np.linspace(12, 18, 34), "toe.mass": np.array([0.3])}
    )
    environment = make(robot=batch, simulations=34)
    environment.reset()
    assert len(environment.chunks) == 2
    heavy = environment.chunks[1].batch.get_model(16)
    assert heavy.body("pelvis").mass[0] == pytest.approx(18)
    assert np.all(environment.step(np.zeros((34, 14))).ending == 0)


def test_a_batch_of_designs_needs_as_many_simulations(make, design):
    with pytest.raises(InputError, match="number of designs"):
        make(robot=design.with_values({"pelvis.mass": np.array([15.0, 16.0])}), simulations=3)


def test_randomisation_gives_simulations_of_their_own(make):
    varied = Randomisation(mass=0.2, floor_friction=0.3, joint_friction=0.5, gains=0.1)
    environment = make(simulations=6, randomisation=varied)
    environment.reset()
    chunk = environment.chunks[0]
    masses = np.array([chunk.batch.get_model(i).body_mass[1:] for i in range(6)])
    ratio = masses / environment.model.body_mass[1:]
    assert np.all(np.abs(ratio - 1) <= 0.2)
    assert len(np.unique(ratio)) == ratio.size
    assert len(np.unique(chunk.drive.coulomb[:, 0, 0])) == 6
    assert len(np.unique(chunk.batch.expanded("geom_friction")[:, 1, 0])) == 6


def test_reward_weights_and_commands_can_be_changed(make):
    environment = make(simulations=40)
    environment.reset()
    environment.set_reward("power", -1.0)
    environment.set_reward("linear_velocity", width=0.05)
    assert environment.chunks[1].rewards["power"].weight == -1.0
    assert environment.chunks[1].rewards["linear_velocity"].parameters["width"] == 0.05
    assert environment.chunks[1].rewards["linear_velocity"].weight == 2.5
    environment.set_commands(forward_low=1.0, forward_high=1.0, test_share=0.0)
    observations = environment.reset()
    np.testing.assert_allclose(observations["policy"][:, 6], 1.0)
    with pytest.raises(InputError, match="not in the task"):
        environment.set_reward("goal_arrival", 1.0)
    with pytest.raises(InputError, match="no such setting"):
        environment.set_commands(speed=1.0)
    with pytest.raises(InputError, match="within"):
        environment.set_commands(test_share=2.0)


def test_signals_agree_with_the_reward_of_power(make, design):
    environment = make(simulations=3)
    environment.recording = True
    environment.reset()
    environment.set_reward("power", -1.0)
    for action in actions_of(environment, 5):
        step = environment.step(action)
    signals, heat = (
        environment.signals(),
        environment.chunks[0].drive.model.envelope.power_constant.reshape(3, 1, -1),
    )
    torque, speed = signals["motor_torque"], signals["motor_velocity"]
    assert torque.shape == (3, 8, 14)
    power = (heat * torque**2 + torque * speed).sum(-1).mean(1)
    np.testing.assert_allclose(step.reward_terms[:, 1], -power * 0.02)
    # the same mechanical power at the joints
    joints = (signals["driven_joint_torque"] * signals["joint_velocity"]).sum(-1)
    np.testing.assert_allclose(joints, (torque * speed).sum(-1), rtol=1e-9, atol=1e-9)


def test_signals_of_a_step_that_ends_an_episode_are_of_that_episode(make):
    environment = make(simulations=4)
    environment.recording = True
    environment.reset()
    for _ in range(200):
        step = environment.step(np.full((4, 14), 2.0))
        signals = environment.signals()
        for simulation in step.ended:
            _, x, y, _ = signals["base_orientation"][simulation, -1]
            assert (
                signals["base_position"][simulation, -1, 2] < 0.6 or 1 - 2 * (x * x + y * y) < 0.7
            )
            assert np.all(np.abs(signals["motor_torque"][simulation]).sum(-1) > 0)
        if len(step.ended):
            return
    pytest.fail("no episode ended")


def test_signals_need_recording(make):
    environment = make()
    environment.reset()
    environment.step(np.zeros((4, 14)))
    with pytest.raises(InputError, match="before the step"):
        environment.signals()


def test_layout_matches_the_environment(make, design):
    assert make().layout.joints == layout_of(design).joints
