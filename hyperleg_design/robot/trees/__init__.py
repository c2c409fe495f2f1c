"""Designs that write their kinematic tree out: reading, checks, limbs, masses and actuation."""
