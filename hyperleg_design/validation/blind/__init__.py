"""The blind trial: plants that nobody fitted, cases with a sealed truth, and one scoring pass.

The plants share no code with the simulation that explains their logs: nothing here imports
`simulation`, `gap.effects`, `gap.playback.replay` or `gap.signals.conditioning`, except
`trial.diagnose_trial` and `real`, which call the diagnosis itself.
"""
