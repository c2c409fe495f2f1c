"""Many designs through the rooms before this one."""
