"""Whether links are heavy enough for the motors in them."""

from __future__ import annotations

from hyperleg_design.robot.checks.finding import Finding
from hyperleg_design.robot.motors import find_motor
from hyperleg_design.robot.trees.limb_masses import limb_masses
from hyperleg_design.robot.trees.tree_design import TreeDesign


def check_housing(design: TreeDesign) -> list[Finding]:
    """Compare the mass of each link with the bare motors that it houses.

    Args:
        design: one robot; the mass of a link includes its motors.

    Returns:
        A warning for each link that is lighter than its motors.
    """
    links, root = limb_masses(design).links, str(design.trunk.link)
    housed: dict[str, list[str]] = {}
    for name, actuator in design.actuator_sections.items():
        link = str(actuator.housed_in)
        housed.setdefault(link, []).extend([name] * (len(design.copies) if link == root else 1))
    findings = []
    for link, names in housed.items():
        motors = [find_motor(str(design.actuator_sections[name].motor)) for name in names]
        mass, inside = float(links[link].mass), sum(motor.mass for motor in motors)
        if mass < inside:
            what = ", ".join(dict.fromkeys(motor.name for motor in motors))
            message = f"weighs {mass:.4g} kg, less than the motors in it ({what}: {inside:.4g} kg)"
            remedy = "name lighter motors, another link under housed_in, or the link's own mass"
            findings.append(Finding("warning", f"links.{link}", message, remedy))
    return findings
