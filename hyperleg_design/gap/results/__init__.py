"""What an answer is: the diagnosis and its schema, and findings about logs."""
