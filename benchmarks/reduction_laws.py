"""What the laws of friction and gears do to the choice of a reduction, and to toe against no toe.

Run: python benchmarks/reduction_laws.py

Cost of transport of the reference walk at 1.33 m/s by inverse dynamics (`sizing.demand`), one factor
on all reductions below the hip, under several values of what the laws assume.
"""  # noqa: E501

from __future__ import annotations

SCALES = (0.7, 0.85, 1.0, 1.2, 1.4, 2.0)
REDUCTIONS = ("knee", "ankle_pitch", "ankle_roll", "toe_ankle_pitch", "toe")
LAWS = {
    "declared": {"friction.law": "declared", "gears.law": "declared"},
    "share 0": {"friction.motor_share": 0.0},
    "share 0.5": {},
    "share 1": {"friction.motor_share": 1.0},
    "loss 0": {"gears.loss_per_doubling": 0.0},
    "loss 0.022": {"gears.loss_per_doubling": 0.022},
    "stages 0": {"gears.stage_mass_per_torque": 0.0},
    "stages 0.003": {"gears.stage_mass_per_torque": 0.003},
}


def main() -> None:
    from hyperleg_design.robot.design import load_design
    from hyperleg_design.sizing.demand import demand

    def row(law: str, variant: str, scale: float) -> None:
        values = LAWS[law] | {f"transmission.scale.{part}": scale for part in REDUCTIONS}
        found = demand(load_design(overrides=values, variant=variant), "walk").summary()
        columns = ("cost_of_transport", "joule", "mechanical", "margin_over_peak")
        shown = [f"{found[column]:.4g}" for column in columns]
        print(law, variant, f"{scale:g}", *shown, sep=", ", flush=True)

    print("law, variant, scale, cost of transport, joule [W], mechanical [W], margin over peak")
    for law in LAWS:
        for scale in SCALES:
            row(law, "toe", scale)
        for variant in ("toe_locked", "toe_removed_matched"):
            row(law, variant, 1.0)


if __name__ == "__main__":
    main()
