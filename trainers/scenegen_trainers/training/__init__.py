"""Teaching networks: recipe, samples, loop, log, pictures."""
