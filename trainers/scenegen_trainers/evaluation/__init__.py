"""How good a network is: scores, strata, intervals, trivial baselines, pictures."""
