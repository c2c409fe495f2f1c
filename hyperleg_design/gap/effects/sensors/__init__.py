"""Effects of sensors that tell something else than the truth."""
