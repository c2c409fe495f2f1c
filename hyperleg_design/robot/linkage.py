"""Posture-dependent cooperative actuation: motor positions from joint positions, and their exact
gradient.

The paper prints reductions in two postures; what lies between is an assumption of ours. Each motor
below the hip turns a pulley on the knee axis by a belt. The pulley's crank drives the ankle through
a four-bar along the shank; the toe motor's goes on through a second four-bar along the foot, from
the ankle axis to the toe axis:

    motor_position = K (-knee + f(ankle pitch) +- k ankle roll)         the ankle motors
    motor_position = K (-knee + g(ankle pitch + h(toe)))                the toe motor

with K the knee reduction and f, g, h the crank angles of four-bars. Lever length and phase of each
are solved so that the printed reductions hold exactly in both postures. `joint_from_motor` is the
gradient of these positions, so the work around any closed path of postures is zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.names import POSTURES
from hyperleg_design.robot.trees.tree_design import TreeDesign

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design

RATIOS = (0.02, 50.0)
"""Ratios of crank to lever between which a four-bar transmits anything [-]."""


@dataclass(frozen=True)
class FourBar:
    """A four-bar linkage: the turn of its crank as a function of the turn of its lever, both zero
    when assembled.

    Angles are measured from the perpendicular to the ground bar. Past the ends of `turns` the ratio
    stays what it is there, which keeps the map invertible outside the range that a real linkage
    would have.
    """

    crank: float
    """Length [m]."""
    lever: float
    """Length [m]."""
    ground: float
    """Length [m]."""
    crank_start: float
    """Crank angle when assembled [rad]."""
    lever_start: float
    """Lever angle when assembled [rad]."""
    turns: tuple[float, float]
    """Turns of the lever between which the linkage is a linkage [rad]."""

    def _crank(self, lever_angle: np.ndarray) -> np.ndarray:
        a, c, d = self.crank, self.lever, self.ground
        coupler_squared = _distance_squared(a, c, d, self.crank_start, self.lever_start)
        cosine = -2 * a * c * np.cos(lever_angle)
        sine = 2 * a * d - 2 * a * c * np.sin(lever_angle)
        right = coupler_squared - a**2 - c**2 - d**2 + 2 * c * d * np.sin(lever_angle)
        return np.arctan2(sine, cosine) - np.arccos(right / np.hypot(cosine, sine))

    def _ratio(self, crank_angle: np.ndarray, lever_angle: np.ndarray) -> np.ndarray:
        a, c, d = self.crank, self.lever, self.ground
        shared = a * c * np.sin(crank_angle - lever_angle)
        return (shared + c * d * np.cos(lever_angle)) / (shared + a * d * np.cos(crank_angle))

    def __call__(self, turn: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        """Turn of the crank [rad] and its derivative [-] at a turn of the lever [rad], `(...)`."""
        turn = np.asarray(turn, float)
        inside = np.clip(turn, *self.turns)
        crank = self._crank(inside + self.lever_start)
        ratio = self._ratio(crank, inside + self.lever_start)
        return crank - self.crank_start + ratio * (turn - inside), ratio

    @classmethod
    def calibrated(
        cls,
        at_rest: float,
        at_turn: float,
        turn: float,
        *,
        crank: float,
        ground: float,
        turns: tuple[float, float],
        crank_start: float,
        field: str,
    ) -> FourBar:
        """Find the four-bar linkage with two given ratios: when assembled, and at one turn of the
        lever.

        Args:
            at_rest: ratio when assembled [-].
            at_turn: ratio at `turn` [-].
            turn: of the lever [rad].
            crank: length of the crank [m].
            ground: distance of the two axes [m].
            turns: range of the lever's turn that must be reached [rad].
            crank_start: angle of the crank when assembled [rad].
            field: parameter that the error names.

        Returns:
            The linkage.

        Raises:
            InputError: no four-bar with these bars does that, all the way between `turns`.
        """
        from scipy.optimize import least_squares

        def linkage_of(unknown: np.ndarray) -> FourBar:
            return cls(
                crank,
                float(np.exp(np.clip(unknown[0], -9, 9))) * crank,
                ground,
                crank_start,
                float(unknown[1]),
                turns,
            )

        def misfit(unknown: np.ndarray) -> np.ndarray:
            bar = linkage_of(unknown)
            with np.errstate(invalid="ignore"):
                ratios = np.array(
                    [bar(np.array(0.0))[1] - at_rest, bar(np.array(turn))[1] - at_turn]
                )
            return np.where(np.isfinite(ratios), ratios, 10.0)

        low, high = RATIOS
        if (
            low < min(at_rest, at_turn)
            and max(at_rest, at_turn) < high
            and turns[0] <= turn <= turns[1]
        ):
            best = least_squares(
                misfit, np.array([np.log(at_rest), 0.0]), xtol=1e-15, ftol=1e-15, gtol=1e-15
            )
            bar = linkage_of(best.x)
            with np.errstate(invalid="ignore"):
                sampled = bar(np.linspace(*turns, 181))[1]
            if np.max(np.abs(best.fun)) < 1e-9 and np.all((low < sampled) & (sampled < high)):
                return bar
        raise InputError(
            "transmission.linkage",
            field,
            round(float(np.rad2deg(turn)), 6),
            f"no four-bar turns the ratio {at_rest:.4g} into {at_turn:.4g} at that angle; change "
            f"the walking posture or the bars",
        )


def _range(design: Design, joint: str) -> tuple[float, float]:
    limits = getattr(design.joints, joint)
    return float(np.deg2rad(limits.lower_deg)), float(np.deg2rad(limits.upper_deg))


def _distance_squared(
    a: float, c: float, d: float, crank_angle: float, lever_angle: float
) -> float:
    return float(
        a**2
        + c**2
        + d**2
        - 2 * a * c * np.cos(crank_angle - lever_angle)
        + 2 * a * d * np.sin(crank_angle)
        - 2 * c * d * np.sin(lever_angle)
    )


@dataclass(frozen=True, eq=False)
class LinkageModel:
    """Motor positions of one leg as a function of its joint positions."""

    hip: np.ndarray
    """Gears of the three hip motors [-]."""
    gears: np.ndarray
    """Gears over the reference build's, of the four motors below the hip [-]."""
    knee: float
    """Reduction from each of those motors to the knee [-]."""
    ankle_roll: float
    """Reduction from the ankle motors to ankle roll [-]."""
    ankle: FourBar
    """f: ankle pitch to crank."""
    toe_shank: FourBar
    """g: idler at the ankle to crank."""
    toe_foot: FourBar
    """h: toe to idler."""
    joints: int
    """Joints that move: 7, or 6 with a locked toe."""
    motors: int
    """Motors that are there."""

    @classmethod
    def of(cls, design: Design) -> LinkageModel:
        """Calibrate the linkage of one robot to the reductions of its two postures.

        Args:
            design: one robot, not a batch.

        Returns:
            The linkage.

        Raises:
            InputError: a batch, reductions that no such linkage gives, or a design that writes its
                tree out.
        """
        if isinstance(design, TreeDesign):
            remedy = "has no linkage of HyperLeg's; joint_from_motor follows the rods of its file"
            raise InputError(design.name, "family", design.family, remedy)
        if design.batch_shape:
            raise InputError(
                design.name,
                "transmission.linkage",
                None,
                "is made for one robot at a time; take one of the batch",
            )
        reductions = {}
        for posture in POSTURES:
            printed, scale = getattr(design.transmission, posture), design.transmission.scale
            reductions[posture] = {
                n: getattr(printed, n) * getattr(scale, n)
                for n in ("knee", "ankle_pitch", "ankle_roll", "toe_ankle_pitch", "toe")
            }
        walking, standing = reductions["walking"], reductions["standing"]
        for name in ("knee", "ankle_roll"):
            if walking[name] != standing[name]:
                raise InputError(
                    design.name,
                    f"transmission.walking.{name}",
                    walking[name],
                    f"must equal the standing one, {standing[name]}: a belt's ratio does not "
                    f"change",
                )
        if not standing["toe_ankle_pitch"] or not walking["toe_ankle_pitch"]:
            raise InputError(
                design.name,
                "transmission.scale.toe_ankle_pitch",
                0.0,
                "decouples the toe from the ankle; the linkage model has no such toe",
            )
        assumed = design.transmission.linkage
        knee = standing["knee"]
        ankle_turn, toe_turn = (
            float(np.deg2rad(assumed.walking_ankle_pitch_deg)),
            float(np.deg2rad(assumed.walking_toe_deg)),
        )
        crank, idler = assumed.crank_length, float(np.deg2rad(assumed.idler_limit_deg))
        ankle = FourBar.calibrated(
            standing["ankle_pitch"] / knee,
            walking["ankle_pitch"] / knee,
            ankle_turn,
            crank=crank,
            ground=assumed.ankle_ground_length,
            turns=_range(design, "ankle_pitch"),
            crank_start=0.0,
            field="walking_ankle_pitch_deg",
        )
        foot = FourBar.calibrated(
            standing["toe"] / standing["toe_ankle_pitch"],
            walking["toe"] / walking["toe_ankle_pitch"],
            toe_turn,
            crank=crank,
            ground=assumed.toe_ground_length,
            turns=_range(design, "toe"),
            crank_start=float(np.deg2rad(assumed.toe_crank_deg)),
            field="walking_toe_deg",
        )
        shank = FourBar.calibrated(
            standing["toe_ankle_pitch"] / knee,
            walking["toe_ankle_pitch"] / knee,
            float(ankle_turn + foot(toe_turn)[0]),
            crank=crank,
            ground=assumed.ankle_ground_length,
            turns=(-idler, idler),
            crank_start=0.0,
            field="walking_toe_deg",
        )
        gears = transmission.gear_ratios(design)
        return cls(
            gears[:3],
            gears[3:],
            knee,
            standing["ankle_roll"],
            ankle,
            shank,
            foot,
            len(transmission.joint_names(design)),
            len(transmission.motor_names(design)),
        )

    def _padded(self, position: np.ndarray) -> np.ndarray:
        position = np.asarray(position, float)
        if position.shape[-1] != self.joints:
            raise ValueError(
                f"joint positions have shape {position.shape}; the last axis must be {self.joints}"
            )
        if self.joints == 7:
            return position
        return np.concatenate([position, np.zeros((*position.shape[:-1], 1))], -1)

    def motor_position(self, position: np.ndarray) -> np.ndarray:
        """Compute the motor angles at joint angles; they are zero at zero.

        Args:
            position: joint angles [rad], `(..., joints)`.

        Returns:
            Motor angles [rad], `(..., motors)`.
        """
        q = self._padded(position)
        knee, pitch, roll = q[..., 3], q[..., 4], self.ankle_roll / self.knee * q[..., 5]
        pulley = self.ankle(pitch)[0]
        idler = pitch + self.toe_foot(q[..., 6])[0]
        below = np.stack(
            [-knee, -knee + pulley + roll, -knee + pulley - roll, -knee + self.toe_shank(idler)[0]],
            -1,
        )
        return np.concatenate([self.hip * q[..., :3], self.knee * self.gears * below], -1)[
            ..., : self.motors
        ]

    def joint_from_motor(self, position: np.ndarray) -> np.ndarray:
        """Compute M at joint angles, the transposed gradient of `motor_position`.

        Args:
            position: joint angles [rad], `(..., joints)`.

        Returns:
            M [-], `(..., joints, motors)`.
        """
        q = self._padded(position)
        matrix = np.zeros((*q.shape[:-1], 7, 7))
        matrix[..., range(3), range(3)] = self.hip
        matrix[..., transmission.KNEE, 3:] = -1.0
        matrix[..., transmission.ANKLE_PITCH, 4:6] = self.ankle(q[..., 4])[1][..., None]
        matrix[..., transmission.ANKLE_ROLL, 4] = self.ankle_roll / self.knee
        matrix[..., transmission.ANKLE_ROLL, 5] = -self.ankle_roll / self.knee
        turned, foot = self.toe_foot(q[..., 6])
        shank = self.toe_shank(q[..., 4] + turned)[1]
        matrix[..., transmission.ANKLE_PITCH, 6] = shank
        matrix[..., transmission.TOE, 6] = shank * foot
        matrix[..., 3:, 3:] *= self.knee * self.gears
        return matrix[..., : self.joints, : self.motors]

    def walking_posture(self, design: Design) -> np.ndarray:
        """State the joint angles at which the walking reductions hold.

        Args:
            design: the robot.

        Returns:
            Joint angles [rad], `(joints,)`; those on which the reductions do not depend are zero.
        """
        q = np.zeros(7)
        q[4] = np.deg2rad(design.transmission.linkage.walking_ankle_pitch_deg)
        q[6] = np.deg2rad(design.transmission.linkage.walking_toe_deg)
        return q[: self.joints]
