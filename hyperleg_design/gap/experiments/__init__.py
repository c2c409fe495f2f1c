"""Excitation, the information that motions carry, and experiments that separate rivals."""
