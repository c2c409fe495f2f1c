"""Tables and figures of designs: masses, envelopes, demand."""
