"""How many simulations are stepped together: parts, models, random numbers, snapshots."""
