"""What a log can and cannot show."""
