"""Which split a clip belongs to, what is kept for the test split alone, and the proof that nothing leaks."""
