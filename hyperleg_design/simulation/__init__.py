"""Simulation: many robots in MuJoCo, their motors' limits and friction, and the tasks they learn
and are tested on.
"""
