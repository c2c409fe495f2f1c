"""From residuals to a posterior over hypotheses.

In the order in which a diagnosis passes them:

| question | module |
|---|---|
| which numbers are the data, and how much does each count? | `samples` |
| how large is the noise of each? | `noise_model`, `white_noise` |
| what is usually a little wrong of every robot, and which residual does it leave? | `nuisance`, `nuisance_traces` |
| how likely is one residual channel: noise, discrepancy, and their scales? | `channels/` |
| how do logs become channels? | `assembly` |
| which residual does an effect leave at a place, linearised? | `linearisation`, `cause`; at every place: `effect_traces` |
| ... beside other causes that change what it acts on? | `interactions` |
| what keeps a cause from scaling noise away? | `endogenous` (torques), `shrinking` (belts), `smoothing` (slow drives) |
| how probable is a set of causes before any log? | `hypotheses/cause_prior` |
| how large are the causes of a set, and what is its evidence? | `hypothesis`, `hypothesis_fit`, `bounded_least_squares`, `limited_scales` there |
| which sets are tried? | `proposals` (what is worth a fit), `search` there |
| which reference log differs from the others? | `hypotheses/reference_differences` |
| how large is the gap, and how much of it closes on data that were left out? | `cross_validation`, `gap_size` |
| does something act that the catalogue lacks? | `unlisted` |
| which verdict, with which probabilities? | `posterior` |
| with which intervals? | `intervals` |
| how small a fault would these logs have shown? | `detectable` |
| what do the feet show that no residual holds? | `detectors/` |

`rules` has the priors and thresholds; what one computation needs alone stands at the top of its module.
"""  # noqa: E501
