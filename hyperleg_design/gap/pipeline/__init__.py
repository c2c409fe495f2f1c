"""The way from logs to a diagnosis."""
