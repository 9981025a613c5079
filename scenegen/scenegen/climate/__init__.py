"""Sun, sky and weather of a place and a day."""
