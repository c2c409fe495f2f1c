"""From joint targets to what joints feel: controllers, motors, transmissions, and their heat."""
