"""What a search works with: bounds on measures, its database, rows as JSON."""
