"""Texts, figures and pages of diagnoses."""
