"""Pictures and animations of robots."""
