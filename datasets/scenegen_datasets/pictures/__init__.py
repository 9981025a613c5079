"""Pictures of a dataset for people: contact sheet and animation. Never part of the data."""
