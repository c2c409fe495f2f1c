"""Detectors of special phenomena that decide beside the fits."""
