"""A quadrotor as flights need it: limits, how fast it takes a path, how it leans, what wind does, what it feels."""
