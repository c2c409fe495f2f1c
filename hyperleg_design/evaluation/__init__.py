"""Tests of a robot and what they are compared with."""
