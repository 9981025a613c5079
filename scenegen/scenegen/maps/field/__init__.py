"""The field map: football pitches and their grounds in rolling farmland."""
