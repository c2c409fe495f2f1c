"""Effects of the ground under feet."""
