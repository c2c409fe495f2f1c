"""The learner: networks, PPO, mirrored samples, and the precision and device of its updates."""
