"""What the ONNX file of a policy says of itself: trainings write it, evaluations read it.

Input `observation` `(n, size)`, output `action` `(n, J)`, both single precision; the normaliser is
in the graph. Metadata (`metadata_props`), JSON texts where not plain:

| key | holds |
|---|---|
| `format` | `POLICY_FORMAT` |
| `columns` | names of the numbers of the observation |
| `joints` | names of the numbers of the action |
| `task`, `design`, `preset` | resolved, as their YAML readers take them |
| `design_ranges` | ranges of the designs that it was trained on, where it observes its design |
| `variant`, `seed`, `steps`, `deviations`, `command`, `commit`, `versions` | how it was made |
"""

from __future__ import annotations

POLICY_FORMAT = "hyperleg-policy-1"
"""Name and version of the metadata of a policy."""
CRITIC_FORMAT = "hyperleg-critic-1"
"""Name and version of the metadata of a critic."""
INPUT, OUTPUT = "observation", "action"
"""Names in the graph."""
