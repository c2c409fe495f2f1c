"""Plants of the blind trial: what a robot with its faults truly does."""
