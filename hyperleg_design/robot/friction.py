"""What is assumed of joint friction beyond the printed Coulomb and viscous parts."""

from __future__ import annotations

FRICTION_SPEED = 0.1
"""Width v_m of the Coulomb friction's tanh [rad/s] (assumed; the paper does not print it)."""
