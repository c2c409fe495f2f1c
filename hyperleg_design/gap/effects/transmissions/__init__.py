"""Effects of belts, cables and gears between motors and joints."""
