"""Effects at joints: friction and springs."""
