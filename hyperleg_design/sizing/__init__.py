"""What a design can do and what it must: envelopes, energy, capability, demand."""
