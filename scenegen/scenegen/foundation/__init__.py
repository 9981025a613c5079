"""What every room stands on: errors, randomness, canonical JSON, atomic files, workers. Imports nothing of ours."""
