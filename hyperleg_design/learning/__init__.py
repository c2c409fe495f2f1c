"""Learning: PPO on the simulation, with `rsl-rl-lib` on torch (the `learning` extra)."""
