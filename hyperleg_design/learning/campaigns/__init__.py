"""Campaigns: all trainings that a comparison needs, listed in one file, run side by side, killed
and resumed at will.
"""
