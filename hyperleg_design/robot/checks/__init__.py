"""Checks of the files that describe robots, and of the numbers of a design."""
