"""The coastline: cliffs, dunes, beach and sea, and what people have built there."""
