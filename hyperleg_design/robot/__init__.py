"""Robots: designs, motors, masses, cooperative actuation, URDF and models."""
