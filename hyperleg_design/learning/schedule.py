"""What changes while a policy is trained: stages, ramps and the assist that goes away, as a
function of steps and progress.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hyperleg_design.simulation.terms.assist import Assist

if TYPE_CHECKING:
    from hyperleg_design.learning.preset import Preset, Ramp, Stage
    from hyperleg_design.simulation.environment import Environment

DECAY_EVERY = 2
"""Iterations between two decays of the assist, where the robots do well enough; assumed."""
LONG_ENOUGH = 500.0
"""Mean episode from which the assist decays [policy steps]; assumed."""
FAST_ENOUGH = 0.7
"""Share of the best velocity reward, or of the speed cap, from which the assist decays [-];
assumed."""


class Schedule:
    """Where a training stands in its stages, and what that sets in the environment."""

    def __init__(self, preset: Preset, task: str) -> None:
        self.preset, self.stages = preset, preset.stages(task)
        self.iteration = 0
        """Iterations done, over all stages."""
        self.gain = 0.0
        """Of the assist."""
        self.gone: list[int | None] = []
        """For each stage begun, its iteration from which there was no assist; None while there
        is."""
        self._update_assist()

    @property
    def total(self) -> int:
        """Number of iterations of all stages together."""
        return sum(self.preset.iterations(stage) for stage in self.stages)

    @property
    def is_late(self) -> bool:
        """Whether the policy of now is one of the last to be kept besides the very last."""
        apart = max(1, round(self.preset.late_apart / self.preset.steps_per_iteration))
        left = self.total - self.iteration
        return left > 0 and left % apart == 0 and left // apart < int(self.preset.late)

    @property
    def place(self) -> tuple[int, int]:
        """Index of the present stage, and iterations done in it; the last one's end when all is
        done.
        """
        left = self.iteration
        for index, stage in enumerate(self.stages):
            length = self.preset.iterations(stage)
            if left < length:
                return index, left
            left -= length
        return len(self.stages) - 1, self.preset.iterations(self.stages[-1])

    @property
    def stage(self) -> Stage:
        """The stage that the next iteration belongs to."""
        return self.stages[self.place[0]]

    def apply(self, environment: Environment) -> None:
        """Set what the next iteration runs with; stages before the present one leave their last
        values.

        Args:
            environment: which is changed.
        """
        environment.assist = Assist(self.gain) if self.gain > 0.0 else None
        index, done = self.place
        for i, stage in enumerate(self.stages[: index + 1]):
            for term, values in stage.rewards.items():
                environment.set_reward(
                    term, values.get("weight"), **{k: v for k, v in values.items() if k != "weight"}
                )
            if stage.commands:
                environment.set_commands(**stage.commands)
            for ramp in stage.ramps:
                if ramp.target[0] in ("policy", "algorithm"):
                    continue
                set_value(
                    environment,
                    ramp,
                    self._progress(ramp, i, done if i == index else self.preset.iterations(stage)),
                )

    @property
    def most_deviation(self) -> float:
        """Largest standard deviation of the actions that the ramps allow at present; infinite
        without.
        """
        return self._latest("policy", float("inf"))

    @property
    def kl_target(self) -> float:
        """Divergence of one update that the learning rate aims at, at present [nat]."""
        return self._latest("algorithm", float(self.preset.algorithm.kl_target))

    def advance(self, mean_episode: float, share: float) -> None:
        """Note that one iteration is done, and let the assist decay where the robots do well
        enough.

        Args:
            mean_episode: length of episodes of late [policy steps].
            share: of the best velocity reward or of the speed cap reached of late [-].
        """
        done = self.place[1] + 1
        if (
            self.gain > 0.0
            and done % DECAY_EVERY == 0
            and mean_episode > LONG_ENOUGH
            and share > FAST_ENOUGH
        ):
            assist = Assist(self.gain)
            assist.decay()
            self.gain = assist.gain
        self.iteration += 1
        self._update_assist()

    def state(self) -> dict[str, Any]:
        """Collect the state that a checkpoint keeps.

        Returns:
            Numbers and lists by name, as `put` takes them.
        """
        return {"iteration": self.iteration, "gain": self.gain, "gone": list(self.gone)}

    def put(self, state: dict[str, Any]) -> None:
        """Restore a state that `state` returned.

        Args:
            state: numbers and lists by name.
        """
        self.iteration, self.gain, self.gone = (
            state["iteration"],
            state["gain"],
            list(state["gone"]),
        )

    def _update_assist(self) -> None:
        index, done = self.place
        stage = self.stages[index]
        if index == len(self.gone):
            self.gain = self.gain if stage.assist is None else stage.assist
            self.gone.append(None)
        if done >= stage.assist_gone_by * self.preset.iterations(stage):
            self.gain = 0.0
        if self.gain == 0.0 and self.gone[index] is None:
            self.gone[index] = done

    def _latest(self, kind: str, value: float) -> float:
        """Value that the latest ramp of a kind gives, of the stages begun; `value` without one."""
        index, done = self.place
        for i, stage in enumerate(self.stages[: index + 1]):
            length = done if i == index else self.preset.iterations(stage)
            for ramp in stage.ramps:
                if ramp.target[0] == kind:
                    value = _between(ramp, self._progress(ramp, i, length))
        return value

    def _progress(self, ramp: Ramp, index: int, done: int) -> float:
        if ramp.begins == "assist_gone":
            gone = self.gone[index]
            if gone is None:
                return 0.0
            done -= gone
        return min(max(done * self.preset.steps_per_iteration / ramp.steps, 0.0), 1.0)


def _between(ramp: Ramp, progress: float) -> float:
    """Value of a ramp at its progress 0 .. 1."""
    return ramp.low + progress * (ramp.high - ramp.low)


def set_value(environment: Environment, ramp: Ramp, progress: float) -> None:
    """Set what a ramp changes.

    Args:
        environment: which is changed.
        ramp: names what is changed, and its range.
        progress: of the ramp, 0 .. 1.
    """
    kind, name, parameter = ramp.target
    value = _between(ramp, progress)
    if kind == "commands":
        environment.set_commands(**{name: value})
    elif kind == "clock":
        environment.set_clock(value)
    elif parameter == "weight":
        environment.set_reward(name, value)
    else:
        environment.set_reward(name, **{parameter: value})
