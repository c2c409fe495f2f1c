"""Mass, centre of mass and inertia of links and robots."""
