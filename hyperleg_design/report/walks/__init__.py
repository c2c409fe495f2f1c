"""Figures and pages of evaluated walks and T-tests."""
