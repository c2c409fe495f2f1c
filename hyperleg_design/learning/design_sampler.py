"""Which designs the simulations of a training have: drawn from a pool over ranges, more often
those with which the policy falls.

Compiling a model for every episode would take longer than the episode, so a training draws from a
pool of designs, whose models are compiled once. Each simulation keeps its design for some
iterations, a little longer than an episode; then the environment is made anew.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.simulation.design_spread import DesignSpread

EVEN = 0.5
"""Share of the draws that are even over the pool; the others follow the falls. Assumed."""
MEMORY = 0.7
"""Weight of the past in each design's fall rate, from one draw to the next; assumed."""


class DesignSampler:
    """The designs of a training's simulations, drawn anew at times.

    Args:
        base: the robot whose leaves are replaced.
        spread: the designs to draw from.
        simulations: of the environment.
        seed: of the training.
    """

    def __init__(
        self, base: RobotDesign, spread: DesignSpread, simulations: int, seed: int
    ) -> None:
        self.pool, self.spread, self.seed = spread.designs(base), spread, seed
        self.simulations, self.draws = simulations, 0
        self.fall_rate = np.zeros(spread.pool)
        """Falls a policy step of late, by design of the pool, 0 before any was seen."""
        self._falls, self._steps = np.zeros(spread.pool), np.zeros(spread.pool)
        self.assigned = np.zeros(simulations, int)
        """Design in the pool of each simulation, `(n,)`."""
        self._draw()

    @property
    def design(self) -> RobotDesign:
        """The simulations' designs, a batch."""
        return self.pool.rows(self.assigned)

    @property
    def environment_seed(self) -> int:
        """Seed of the environment that has the present designs; other than that of any other
        draw.
        """
        sequence = np.random.SeedSequence([self.seed, self.draws])
        return int(sequence.generate_state(1)[0])

    @property
    def probability(self) -> np.ndarray:
        """With which each design of the pool is drawn next, `(pool,)`."""
        even = np.full(self.spread.pool, 1.0 / self.spread.pool)
        total = self.fall_rate.sum()
        return even if total == 0 else EVEN * even + (1 - EVEN) * self.fall_rate / total

    def note(self, terminated: np.ndarray) -> None:
        """Take in which simulations fell in one policy step.

        Args:
            terminated: `(n,)`.
        """
        self._falls += np.bincount(self.assigned, terminated, self.spread.pool)
        self._steps += np.bincount(self.assigned, minlength=self.spread.pool)

    def redraw(self) -> None:
        """Assign designs anew, by the falls since the last draw and before."""
        seen = self._steps > 0
        rate = self._falls[seen] / self._steps[seen]
        self.fall_rate[seen] = MEMORY * self.fall_rate[seen] + (1 - MEMORY) * rate
        self._falls[:], self._steps[:] = 0.0, 0.0
        self.draws += 1
        self._draw()

    def state(self) -> dict[str, Any]:
        """Collect all that the future of the sampler depends on.

        Returns:
            Numbers and arrays by name, as `put` takes them.
        """
        return {
            "draws": self.draws,
            "assigned": self.assigned,
            "fall_rate": self.fall_rate,
            "falls": self._falls,
            "steps": self._steps,
        }

    def put(self, state: dict[str, Any]) -> None:
        """Restore a state that `state` returned.

        Args:
            state: numbers and arrays by name.
        """
        self.draws = int(state["draws"])
        self.assigned, self.fall_rate = state["assigned"].copy(), state["fall_rate"].copy()
        self._falls, self._steps = state["falls"].copy(), state["steps"].copy()

    def _draw(self) -> None:
        """Low-variance resampling: each design gets its expected number of simulations, rounded
        down or up.
        """
        rng = np.random.default_rng([self.seed, self.draws])
        places = (rng.random() + np.arange(self.simulations)) / self.simulations
        edges = np.cumsum(self.probability)
        self.assigned = np.searchsorted(edges / edges[-1], places, side="right")
