"""Parts of a task that are one small function each: observations, rewards, ends of episodes."""
