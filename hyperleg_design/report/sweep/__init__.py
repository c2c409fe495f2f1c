"""Figures and pages of sweeps."""
