"""Effects that no answer names as a cause, and that compete with those of the catalogue."""
