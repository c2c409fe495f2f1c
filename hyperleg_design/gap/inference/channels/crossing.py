"""Sums of products of columns with all channels, which no scale and no size of a cause changes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.inference.channels.channel import Channel
from hyperleg_design.gap.inference.channels.residual import Residual
from hyperleg_design.gap.inference.channels.scales import Scales


@dataclass(frozen=True, eq=False)
class Crossing:
    """Products of m columns with each channel and among themselves."""

    count: int
    """Number m of parameters of all causes."""
    shown: tuple[np.ndarray, ...]
    """Of each channel, the columns that are anything there `(some,)`."""
    cross: tuple[np.ndarray, ...]
    """With discrepancy columns and residual, by cell `(cells, k + 1, some)`; see
    `Channel.crossed`."""
    own: tuple[np.ndarray, ...]
    """Among themselves, by cell `(cells, some, some)`."""

    @classmethod
    def of(cls, channels: Sequence[Channel], columns: np.ndarray) -> Crossing:
        """Compute the products of columns with all channels.

        Args:
            channels: of the evidence.
            columns: weighted as the residual `(m, S)`.
        """
        present = columns != 0  # numpy looks through truth values many times faster than numbers
        shown = tuple(np.flatnonzero(channel.shows(present)) for channel in channels)
        crossed = [
            channel.crossed(columns, some) for channel, some in zip(channels, shown, strict=True)
        ]
        return cls(
            len(columns), shown, tuple(cross for cross, _ in crossed), tuple(o for _, o in crossed)
        )

    def extended(
        self, channels: Sequence[Channel], known: np.ndarray, further: np.ndarray
    ) -> Crossing:
        """Products of the first of these columns and of further ones, the products of the first
        ones as they are.

        Args:
            channels: of which these are the products.
            known: the first columns `(k, S)`.
            further: the further ones `(m, S)`.
        """
        new = Crossing.of(channels, further)
        shown, crosses, owns = [], [], []
        for channel, before, some, *products in zip(
            channels, self.shown, new.shown, self.cross, self.own, new.cross, new.own, strict=True
        ):
            first = before[before < len(known)]
            cross, own, new_cross, new_own = products
            between = channel.crossed_with(known, first, further, some)
            own = own[:, : len(first), : len(first)]
            shown.append(np.concatenate([first, len(known) + some]))
            crosses.append(np.concatenate([cross[:, :, : len(first)], new_cross], axis=2))
            owns.append(np.block([[own, between], [between.transpose(0, 2, 1), new_own]]))
        return Crossing(len(known) + new.count, tuple(shown), tuple(crosses), tuple(owns))

    def left(self, channels: Sequence[Channel], theta: np.ndarray) -> list[Residual]:
        """What is left of each channel's residual without a trace over these columns.

        Args:
            channels: of which these are the products.
            theta: the trace over the columns `(m,)`.
        """
        each = zip(channels, self.shown, self.cross, self.own, strict=True)
        return [
            channel.left(cross, own, theta[some]) if len(some) else channel.whole_residual
            for channel, some, cross, own in each
        ]

    def reduced(self, channels: Sequence[Channel], scales: Sequence[Scales]) -> np.ndarray:
        """Products of residual and columns in the metric of the marginal covariance, over all
        channels.

        Args:
            channels: of which these are the products.
            scales: hyperparameters by channel.

        Returns:
            `(m + 1, m + 1)`, the residual first.
        """
        products = np.zeros((self.count + 1, self.count + 1))
        for channel, its, some, cross, own in zip(
            channels, scales, self.shown, self.cross, self.own, strict=True
        ):
            place = np.r_[0, 1 + some]
            products[np.ix_(place, place)] += (
                channel.reduced(its, cross, own) if len(some) else channel.reduced(its)
            )
        return products
