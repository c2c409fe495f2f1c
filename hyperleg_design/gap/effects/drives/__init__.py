"""Effects of motors, their controllers and their battery."""
