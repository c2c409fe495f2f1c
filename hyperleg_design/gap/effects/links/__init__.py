"""Effects of links: masses and where they are."""
