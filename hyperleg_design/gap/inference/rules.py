"""Every number that the inference decides by, with its unit and where it comes from.

Labels: *derived* follows from something else in the project, *assumed* is an engineering estimate,
*developed* was chosen on the development cases of the benchmark (`validation/`) and simulated
robots, never on held-out cases.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass, field

from hyperleg_design.errors import InputError


@dataclass(frozen=True)
class NoiseRules:
    """How much the samples of a residual tell."""

    information: float = 0.4
    """Share of the independent numbers of white noise that a sample counts for [-]; what is left of
    a motion repeats with it (developed)."""
    torque: float = 0.008
    """What drives and models leave, of the torque of a joint in the same band and half second [-]
    (developed)."""
    friction: float = 0.04
    """The same of the model's Coulomb friction [-] (developed)."""
    turning: float = 0.2
    """The same, while a joint turns round and its friction turns over [-] (developed)."""
    leak: float = 0.001
    """The same of the whole torque, into every band [-] (developed)."""
    turning_way: float = 0.006
    """Half of the way on which friction may turn over as a joint turns round [rad] (assumed)."""
    turning_time: float = 0.05
    """Time around it for which that counts [s] (assumed)."""
    near: float = 0.5
    """Time over which the size of a load is averaged [s] (assumed)."""
    rounding: float = 1e-4
    """Least deviation of noise over the torque that a joint is made for [-]: what single precision
    and rounding in logs leave (assumed)."""
    weight: float = 4.0
    """Independent numbers that the expected noise counts for when that of a channel and band is
    estimated [-] (assumed)."""
    least: float = 0.5
    """Variance over the expected that noise in logs under test may always have [-] (assumed)."""
    spread: float = 0.7
    """Deviation of the logarithm of a healthy robot's noise in logs under test over that in its
    references [-] (developed)."""
    alone_spread: float = 2.0
    """The same over the expected noise, without references [-]: measured torques of real drives
    have up to a hundred times the expected variance (developed)."""
    unlisted: float = 2.0
    """Median of the same logarithm where something unlisted makes noise, over the healthy
    deviation [-] (assumed)."""
    unlisted_spread: float = 3.0
    """Deviation of it, likewise [-] (assumed)."""


@dataclass(frozen=True)
class DiscrepancyRules:
    """What the model of a healthy robot leaves of a residual, as a function of its state.

    A scale multiplies the prior deviations of all discrepancy columns of one channel; its logarithm
    has a normal prior.
    """

    share: float = 0.01
    """Deviation of one shape over the load of its channel at scale 1 [-] (developed)."""
    waves: int = 12
    """Random cosine features beside the named shapes [-] (assumed)."""
    standing: float = 1.0
    """Median of the scale that all sessions share, without references [-] (developed)."""
    standing_spread: float = 0.7
    """Deviation of its logarithm [-] (developed)."""
    referenced: float = 2.0
    """Median of the same where reference logs teach it [-] (developed)."""
    referenced_spread: float = 1.5
    """Deviation of its logarithm [-]: references tell it, so the prior is wide (assumed)."""
    change: float = 0.3
    """Median of the scale of what changes from session to session [-] (developed)."""
    change_spread: float = 0.7
    """Deviation of its logarithm [-] (developed)."""
    unlisted: float = 8.0
    """Median of the scale of an unlisted effect, over that of a healthy robot [-] (assumed)."""
    unlisted_spread: float = 1.0
    """Deviation of its logarithm [-] (assumed)."""
    unlisted_probability: float = 0.02
    """Prior probability that something unlisted acts on one channel [-] (assumed)."""
    truncation: float = 1e-3
    """Directions of the discrepancy that change the residuals by less than this share of one
    deviation of the noise, squared and summed over all samples, are left out [-] (derived)."""


@dataclass(frozen=True)
class CauseRules:
    """What is known of causes before any log."""

    probability: float = 0.5
    """That the model lacks anything of the catalogue, and that it lacks one thing more [-]
    (assumed)."""
    changed: float = 0.05
    """That anything has changed since the references, and that one thing more has [-] (developed:
    of faults drawn on logs of a real robot, true causes led by 5 nats and more, false ones by 1 to
    4)."""
    again: float = 0.5
    """That a further cause is an effect that acts at another place already [-]: gears, drives and
    settings of one kind fail alike (assumed)."""
    usual: float = 3.0
    """Deviations of the usual calibration error beyond which a size is a fault, of causes that
    no reference logs tell from it [-] (assumed)."""
    parameter: float = 0.5
    """Log prior odds against each parameter, beside what the marginal likelihood takes for it [nat]
    (assumed)."""
    missing: float = 4.0
    """Log odds against more than the share `missing_from` of what a model describes being missing
    [nat] (assumed: friction that nobody described is usual, and joints run in, but none runs
    freely, nor is a rotor without inertia)."""
    missing_from: float = 0.5
    """That share [-] (assumed)."""
    width: float = 3.0
    """Prior deviation of a parameter over its effect's usual size [-]; a fit beyond it widens it
    (assumed)."""


@dataclass(frozen=True)
class SearchRules:
    """How far the hypotheses are searched."""

    causes: int = 4
    """Most places or groups of places in one set [-]."""
    standing: int = 12
    """Most of them that a model lacks in all logs [-]: friction at every joint, for one."""
    candidates: int = 8
    """Effects at places that are fitted to the end in one step [-]."""
    flexible: int = 2
    """Flexible effects at places that are fitted beside them [-]."""
    starts: int = 2
    """Starts that a nonlinear effect, and variants that a linear one is fitted from [-]."""
    steps: int = 5
    """Gauss-Newton steps of a start [-]."""
    least: float = 0.0
    """Least predicted gain of a cause that is fitted [nat] (assumed)."""
    groups: int = 4
    """Effects that are tried at all of their places at once in one step [-]."""
    bent: int = 2
    """Nonlinear effects among them whose gain there is computed [-]."""
    pairs: int = 2
    """Rivals at the place of a cause beside which a second one is tried there [-]."""
    rounds: int = 12
    """Most rounds of fitting causes and scales in turn [-]."""
    scales: float = 2.0
    """Noise under test over a healthy robot's, in variance, and discrepancy, at most where causes
    are looked for [-] (assumed)."""
    converged: float = 0.02
    """Step of a nonlinear fit, over usual sizes, below which it has converged [-]."""
    settled: float = 0.05
    """Change of a cause in one round, over its deviation, from which both have converged [-]."""


@dataclass(frozen=True)
class PosteriorRules:
    """From log evidence to an answer."""

    temperature: float = 0.6
    """Factor on differences of log evidence when probabilities are stated [-] (developed)."""
    likely: float = 0.5
    """Posterior probability of any cause at all from which causes are named [-]."""
    alike: float = 2.5
    """Difference of log posterior within which rivals count as one set [nat] (developed)."""
    main_part: float = 0.5
    """Share of the gap that causes must close, else the answer is `unknown`, and that other logs
    must foretell of what feet and the IMU tell [-] (assumed)."""
    least_closed: float = 0.1
    """Share of the gap where it shows that a cause closes at least, beside one that does [-]
    (developed: of 266 causes that were named, the 190 true ones close 0.37 and more, 0.21 in a
    simulated pair of frictions, and 21 of the 76 untrue ones less than 0.1)."""
    counts: float = 0.25
    """Share of the largest excess of any channel, from which a channel counts for the gap [-]
    (assumed)."""
    clear: float = 2.0
    """Standard deviations of a parameter from its null, from which an effect that acts at all of
    its places is named at one of them [-]."""
    ringing: float = 20.0
    """Density of a residual above its motion over that of the references, from which a joint rings
    [-] (developed: at most 7 times where loops are stable and no belt is soft, whatever else is
    wrong, and 24 to 1600 times where play knocks)."""
    remainder: float = 0.1
    """Share of the gap that is left, from which a remainder is reported [-] (assumed)."""
    interval: float = 1.4
    """Factor on the standard deviations of parameters [-]: what models of friction and drives get
    wrong is in none of them (developed)."""
    torque_error: float = 0.1
    """Standard deviation of the scale of torques that nothing tells but targets and the gains that
    logs declare [-]: those rest on torque constants of data sheets (assumed)."""
    most_certain: float = 0.94
    """Highest probability that is stated [-] (measured: of 71 answers to development cases of the
    benchmark with 0.95 or more, 67 were right; without any one of its robots 93 to 96 %)."""
    most_certain_alone: float = 0.77
    """The same without references [-] (measured: of 25 answers to development cases with 0.9 or
    more, 19 were right, and of 10 to strangers' robots 8)."""

    def highest(self, referenced: bool) -> float:
        """Highest probability that is stated.

        Args:
            referenced: whether there are reference logs.

        Returns:
            The probability [-].
        """
        return self.most_certain if referenced else self.most_certain_alone


@dataclass(frozen=True)
class GroundRules:
    """From how feet slide and sink to a ground that differs from the model's."""

    slides: float = 0.015
    """Speed against the force from which a contact may slide [m/s] (assumed: above what encoders'
    noise makes)."""
    straight: float = 2.0
    """Least ratio of that speed to the one across the force [-] (assumed)."""
    least_time: float = 0.3
    """Least time that a foot slides [s] (developed: a foot that crept seemed to for 0.16 s, feet on
    slippery floors did for 0.6 s and more)."""
    same: float = 0.2
    """Largest range of the middle half of the ratios of force to load over their median, so that
    they count as one coefficient [-] (developed: noise of the forces makes 0.1 to 0.15 of it on
    slippery floors, and feet that stick 0.7 and more)."""
    beyond: float = 1.3
    """Ratio over the sliding one that loaded ticks exceed seldom [-] (developed, likewise)."""
    seldom: float = 0.02
    """Share of the loaded ticks that may exceed it [-] (assumed)."""
    speeds: float = 1.5
    """Least ratio of fast to slow sliding (percentiles 90 and 10 of the speed) [-]: at a single
    speed a creeping foot has a single ratio, too (assumed)."""
    slippery: float = 2.0
    """Least difference from the nominal friction that is a finding, over the usual one [-]
    (assumed)."""
    day: float = 0.7
    """Change of a ground's friction from one session to the next, over the usual difference from
    the nominal one [-] (assumed)."""
    soft: float = 1.5
    """Least difference from the nominal compliance that is a finding, over the usual one [-]
    (assumed)."""
    certain: float = 3.0
    """Least excess of the compliance over the nominal one, in its standard errors [-] (assumed)."""
    pads: float = 0.1
    """Relative error of the compliance that all pads of a foot share [-] (assumed: their heights
    are off alike)."""
    loads: float = 4.0
    """Least standard deviation of a pad's load [N] (assumed)."""
    ticks: int = 200
    """Least ticks of a pad under load in a log [-] (assumed)."""
    contacts: int = 4
    """Least number of pads, those of each log counted apart, whose scatter gives the standard error
    [-]; a foot with fewer pads is cut into stretches of time (assumed)."""


@dataclass(frozen=True)
class InferenceRules:
    """All rules of the inference."""

    noise: NoiseRules = field(default_factory=NoiseRules)
    discrepancy: DiscrepancyRules = field(default_factory=DiscrepancyRules)
    cause: CauseRules = field(default_factory=CauseRules)
    search: SearchRules = field(default_factory=SearchRules)
    posterior: PosteriorRules = field(default_factory=PosteriorRules)
    ground: GroundRules = field(default_factory=GroundRules)

    def __post_init__(self) -> None:
        """Check that numbers are finite and not negative, and prior probabilities below 1.

        Raises:
            InputError: a number that is not.
        """
        for section in dataclasses.fields(self):
            values = getattr(self, section.name)
            for rule in dataclasses.fields(values):
                value = getattr(values, rule.name)
                below = 1.0 if rule.name.endswith("probability") else math.inf
                if not 0 <= value < below:
                    place = f"{section.name}.{rule.name}"
                    remedy = f"expects a number from 0 to below {below:g}"
                    if below == math.inf:
                        remedy = "expects a finite number, 0 or more"
                    raise InputError("inference rules", place, value, remedy)
