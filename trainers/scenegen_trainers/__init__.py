"""What learns from the data and how it is judged."""
