"""Analyses that are planned before their trainings: outcomes, tests and what came out."""
