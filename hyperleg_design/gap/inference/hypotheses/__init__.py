"""Sets of causes: their prior probability, their fit, and the search for the likeliest."""
