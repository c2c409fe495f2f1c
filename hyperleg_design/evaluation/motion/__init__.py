"""What is measured on recorded motion: steps, gait, contact forces, posture, motors and power."""
