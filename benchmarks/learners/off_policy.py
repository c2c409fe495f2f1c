"""An off-policy learner beside PPO, on the same task, stages, assist and trials.

Soft actor-critic with what makes it fit many parallel robots (FastTD3, Seo et al., 2025; FastSAC
and FlashSAC after it): large batches, small networks with layer norm, a pair of critics that give
a distribution over returns, actions that span each joint's own range, samples mirrored with
probability one half.

    python benchmarks/learners/off_policy.py --out results/learners/off_policy-0 --minutes 10

`progress.jsonl` in the folder is that of `hyperleg train`, with the same trials.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import nn
from torch.nn import functional as F

from hyperleg_design.learning.learner.symmetry import Mirrors
from hyperleg_design.learning.preset_file import load_preset
from hyperleg_design.learning.records.meter import Meter
from hyperleg_design.learning.records.progress import finite
from hyperleg_design.learning.records.trial import trial
from hyperleg_design.learning.schedule import Schedule
from hyperleg_design.learning.training import TRIAL_SEED
from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.tasks import load_task

BATCH, DISCOUNT, TRACKING, RATE = 2048, 0.98, 0.05, 3e-4
ATOMS, BOUND = 51, 8.0
"""Of the distribution of returns: values within plus and minus the bound."""
STEPS_KEPT = 1500
"""Of each robot in the replay buffer."""
REACH = 1.2
"""Farthest joint target from the default posture, inside the joint's range [rad]."""
ENTROPY = -1.0
"""Wanted of the policy, a joint [nat]."""
LEAST_LOG_DEVIATION = -4.0


class Normaliser:
    """Running mean and deviation of observations."""

    def __init__(self, size: int) -> None:
        self.mean, self.variance, self.count = torch.zeros(size), torch.ones(size), 1e-4

    def take(self, values: torch.Tensor) -> None:
        count = len(values)
        delta, total = values.mean(0) - self.mean, self.count + count
        spread = self.variance * self.count + values.var(0, correction=0) * count
        self.variance = (spread + delta**2 * self.count * count / total) / total
        self.mean, self.count = self.mean + delta * count / total, min(total, 2e6)

    def __call__(self, values: torch.Tensor) -> torch.Tensor:
        return ((values - self.mean) / (self.variance.sqrt() + 0.01)).clamp(-8, 8)


class Actor(nn.Module):
    """Squashed Gaussian policy with actions in -1 .. 1."""

    def __init__(self, size: int, joints: int) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        for before, after in ((size, 256), (256, 128)):
            layers += [nn.Linear(before, after), nn.LayerNorm(after), nn.SiLU()]
        self.body = nn.Sequential(*layers)
        self.mean, self.deviation = nn.Linear(128, joints), nn.Linear(128, joints)
        for layer in (self.mean, self.deviation):
            layer.weight.data.mul_(0.01)
            layer.bias.data.zero_()

    def forward(self, values: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        hidden = self.body(values)
        log = LEAST_LOG_DEVIATION * (1 - 0.5 * (torch.tanh(self.deviation(hidden)) + 1))
        return self.mean(hidden), log

    def sample(self, values: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        mean, log = self(values)
        noise = torch.randn_like(mean)
        raw = mean + log.exp() * noise
        squashing = 2 * (math.log(2) - raw - F.softplus(-2 * raw))
        density = -0.5 * noise**2 - log - 0.5 * math.log(2 * math.pi) - squashing
        return torch.tanh(raw), density.sum(-1)


class Critics(nn.Module):
    """Two critics as one batched network: logits of the returns' distribution, `(2, n, ATOMS)`."""

    def __init__(self, size: int) -> None:
        super().__init__()
        widths = [size, 384, 256, 128, ATOMS]
        pairs = list(pairwise(widths))
        self.weights = nn.ParameterList(
            nn.Parameter(torch.empty(2, a, b).uniform_(-1, 1) / math.sqrt(a)) for a, b in pairs
        )
        self.biases = nn.ParameterList(nn.Parameter(torch.zeros(2, 1, b)) for _, b in pairs)
        self.scales = nn.ParameterList(nn.Parameter(torch.ones(2, 1, b)) for _, b in pairs[:-1])
        self.weights[-1].data.mul_(0.1)

    def forward(self, state: torch.Tensor, action: torch.Tensor) -> torch.Tensor:
        values = torch.cat([state, action], -1).expand(2, -1, -1)
        for weight, bias, scale in zip(self.weights, self.biases, self.scales, strict=False):
            values = torch.baddbmm(bias, values, weight)
            values = F.silu(F.layer_norm(values, values.shape[-1:]) * scale)
        return torch.baddbmm(self.biases[-1], values, self.weights[-1])


class OffPolicy:
    """The learner: networks, replay buffer and updates."""

    def __init__(self, environment: Environment, observations: dict[str, np.ndarray]) -> None:
        layout, scale = environment.layout, float(environment.task.control.scale)
        self.up, self.down = (
            torch.tensor(np.clip(reach, 0.1, REACH) / scale, dtype=torch.float32)
            for reach in (layout.upper - layout.default, layout.default - layout.lower)
        )
        self.mirrors = Mirrors(environment.mirror_maps())
        robots, joints = environment.simulations, environment.action_size
        sizes = {name: observations[name].shape[1] for name in ("policy", "critic")}
        self.normalisers = {name: Normaliser(size) for name, size in sizes.items()}
        self.actor = Actor(sizes["policy"], joints)
        self.critics, self.targets = (Critics(sizes["critic"] + joints) for _ in range(2))
        self.targets.load_state_dict(self.critics.state_dict())
        self.log_temperature = torch.tensor(math.log(0.01), requires_grad=True)
        self.optimisers = {
            "actor": torch.optim.AdamW(self.actor.parameters(), RATE, fused=True),
            "critics": torch.optim.AdamW(self.critics.parameters(), RATE, fused=True),
            "temperature": torch.optim.Adam([self.log_temperature], RATE),
        }
        self.support = torch.linspace(-BOUND, BOUND, ATOMS)
        shapes = {"policy": sizes["policy"], "critic": sizes["critic"]}
        shapes |= {f"next_{name}": size for name, size in sizes.items()} | {"action": joints}
        self.kept = {name: torch.zeros(STEPS_KEPT, robots, size) for name, size in shapes.items()}
        self.kept |= {name: torch.zeros(STEPS_KEPT, robots) for name in ("reward", "goes_on")}
        self.head = self.filled = self.updates = 0
        self.losses: dict[str, float] = {}

    def joint_action(self, action: torch.Tensor) -> np.ndarray:
        """Actions of the environment, whose ends are the joint's own."""
        return torch.where(action > 0, action * self.up, action * self.down).numpy()

    def policy(self, observation: np.ndarray) -> np.ndarray:
        with torch.inference_mode():
            values = self.normalisers["policy"](torch.from_numpy(observation))
            return self.joint_action(torch.tanh(self.actor(values)[0]))

    def keep(self, **values: torch.Tensor) -> None:
        for name, array in values.items():
            self.kept[name][self.head] = array
        self.head, self.filled = (self.head + 1) % STEPS_KEPT, min(self.filled + 1, STEPS_KEPT)

    def batch(self) -> dict[str, torch.Tensor]:
        """Samples, each mirrored with probability one half."""
        robots = self.kept["reward"].shape[1]
        step, robot = torch.randint(self.filled, (BATCH,)), torch.randint(robots, (BATCH,))
        found = {name: values[step, robot] for name, values in self.kept.items()}
        half = (torch.rand(BATCH) < 0.5)[:, None]
        for name in ("policy", "critic", "next_policy", "next_critic", "action"):
            plain = name.removeprefix("next_")
            mirror = self.mirrors.action if plain == "action" else self.mirrors.groups[plain]
            found[name] = torch.where(half, mirror(found[name]), found[name])
            if plain != "action":
                found[name] = self.normalisers[plain](found[name])
        return found

    def update(self) -> None:
        """One step of both critics; of actor and temperature every other time."""
        data, temperature = self.batch(), self.log_temperature.exp().detach()
        with torch.no_grad():
            action, density = self.actor.sample(data["next_policy"])
            probability = self.targets(data["next_critic"], action).softmax(-1).mean(0)
            value = self.support - temperature * density[:, None]
            returns = data["reward"][:, None] + DISCOUNT * data["goes_on"][:, None] * value
            wanted = self.projected(returns, probability)
        logits = self.critics(data["critic"], data["action"])
        loss = -(wanted * logits.log_softmax(-1)).sum(-1).mean(1).sum()
        self.step("critics", loss)
        with torch.no_grad():
            torch._foreach_lerp_(
                list(self.targets.parameters()), list(self.critics.parameters()), TRACKING
            )
        self.updates += 1
        if self.updates % 2:
            return
        self.critics.requires_grad_(False)
        action, density = self.actor.sample(data["policy"])
        value = (self.critics(data["critic"], action).softmax(-1) * self.support).sum(-1).mean(0)
        self.step("actor", (temperature * density - value).mean())
        self.critics.requires_grad_(True)
        excess = (density.detach() + ENTROPY * action.shape[-1]).mean()
        self.step("temperature", -self.log_temperature.exp() * excess)
        self.losses = {"critic": loss.item(), "value": value.mean().item()}

    def projected(self, returns: torch.Tensor, probability: torch.Tensor) -> torch.Tensor:
        """A distribution over any returns as one over the support (Bellemare et al., 2017)."""
        place = (returns.clamp(-BOUND, BOUND) + BOUND) * (ATOMS - 1) / (2 * BOUND)
        place = place.clamp(0, ATOMS - 1 - 1e-4)
        low = place.long()
        found = torch.zeros_like(probability)
        found.scatter_add_(-1, low, probability * (1 - (place - low)))
        return found.scatter_add_(-1, low + 1, probability * (place - low))

    def step(self, name: str, loss: torch.Tensor) -> None:
        self.optimisers[name].zero_grad()
        loss.backward()
        self.optimisers[name].step()


def rollout_step(
    environment: Environment, learner: OffPolicy, observations: dict[str, np.ndarray]
) -> Any:
    """One policy step of all robots, kept for learning; cut episodes go on in value."""
    now = {name: torch.from_numpy(values.copy()) for name, values in observations.items()}
    for name, normaliser in learner.normalisers.items():
        normaliser.take(now[name])
    with torch.no_grad():
        action, _ = learner.actor.sample(learner.normalisers["policy"](now["policy"]))
    step = environment.step(learner.joint_action(action))
    after = {name: torch.from_numpy(values.copy()) for name, values in step.observations.items()}
    for name, values in step.final_observations.items():
        after[name][torch.from_numpy(step.ended)] = torch.from_numpy(values)
    learner.keep(
        **now,
        **{f"next_{name}": values for name, values in after.items()},
        action=action,
        reward=torch.from_numpy(step.reward.astype(np.float32)),
        goes_on=torch.from_numpy((~step.terminated).astype(np.float32)),
    )
    return step


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--task", default="walk_free")
    parser.add_argument("--design", default="toe")
    parser.add_argument("--preset", default=str(Path(__file__).with_name("off_policy.yaml")))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--minutes", type=float, default=10.0, help="of processor time")
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    torch.set_num_threads(1)
    torch.manual_seed(given.seed)
    task, design, preset = (
        load_task(given.task),
        load_design(given.design),
        load_preset(given.preset),
    )
    given.out.mkdir(parents=True, exist_ok=True)
    environment = Environment(
        design, task, simulations=int(preset.simulations), seed=given.seed, threads=1
    )
    schedule = Schedule(preset, task.name)
    schedule.apply(environment)
    observations = environment.reset()
    learner, meter = OffPolicy(environment, observations), Meter(environment)
    seconds = 0.0
    with (given.out / "progress.jsonl").open("w") as stream:
        while schedule.iteration < schedule.total and seconds < 60 * given.minutes:
            begun = time.process_time()
            schedule.apply(environment)
            gain = schedule.gain
            for _ in range(int(preset.rollout)):
                step = rollout_step(environment, learner, observations)
                meter.note(step)
                observations = step.observations
                if learner.filled >= 20:
                    learner.update()
            measures = meter.read()
            schedule.advance(measures["episode"], measures["share"])
            seconds += time.process_time() - begun
            row: dict[str, Any] = {
                "iteration": schedule.iteration,
                "steps": schedule.iteration * preset.steps_per_iteration,
                "assist": gain,
                **measures,
                "losses": learner.losses,
                "processor_minutes": seconds / 60,
            }
            if schedule.iteration % int(preset.trial_every) == 0:
                row["trial"] = trial(design, task, learner.policy, seed=TRIAL_SEED)
                print(f"{row['steps'] / 1e6:.2f} M, {seconds / 60:.1f} min, {row['trial']}")
            stream.write(json.dumps(finite(row)) + "\n")
            stream.flush()
    environment.close()


if __name__ == "__main__":
    main()
