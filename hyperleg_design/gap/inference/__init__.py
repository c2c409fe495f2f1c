"""From residuals to a posterior over hypotheses.

Stages in the order in which a diagnosis passes them. Sections are those of
`docs/concepts/diagnosis.md`.

| stage | module | section |
|---|---|---|
| choose the numbers that are the data, and what each counts | `samples` | 1 |
| estimate the noise of each | `noise_model`, `white_noise` | 1 |
| predict what an effect leaves at a place, linearised | `linearisation`, `cause`; at every place: `effect_traces` | 2 |
| ... beside other causes that change what it acts on | `interactions` | details |
| predict what usual calibration errors leave | `nuisance`, `nuisance_traces` | 3 |
| fit effects that no answer names | `unlisted` | 4 |
| compute the likelihood of a residual channel, with its scales | `channels/` | 5 |
| make channels of logs | `log_set`, `assembly` | 5 |
| correct it for noise that causes scale | `endogenous` (torques), `shrinking` (belts), `smoothing` (slow drives) | details |
| set the prior of a set of causes | `hypotheses/cause_prior` | 6 |
| fit the causes of a set, and compute its evidence | `hypotheses/`: `hypothesis`, `hypothesis_fit`, `bounded_least_squares`, `limited_scales` | 6 |
| search for the best set | `hypotheses/`: `proposals` (what is worth a fit), `search` | 6 |
| compare references with one another | `hypotheses/reference_differences` | 6 |
| measure the gap, and how much closes on data that were left out | `cross_validation`, `gap_size` | 7 |
| choose the verdict, with probabilities | `posterior` | 7 |
| compute intervals | `intervals` | 7 |
| find what feet show of their ground, and joints that ring | `detectors/` | 7 |
| state how small a fault these logs would have shown | `detectable` | 8 |

`rules` has the priors and thresholds; what one computation needs alone stands at the top of its module.
"""  # noqa: E501
