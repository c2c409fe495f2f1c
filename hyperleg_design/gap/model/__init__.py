"""The nominal robot: its file or design, kinematic tree, inverse dynamics and drive limits."""
