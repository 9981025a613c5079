"""What a dataset is like, measured: one file per audit, each with a frozen result and a verdict in words."""
