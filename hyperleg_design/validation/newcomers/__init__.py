"""Cases on small robots as a newcomer writes them: MJCF and plain MuJoCo loops, nothing else."""
