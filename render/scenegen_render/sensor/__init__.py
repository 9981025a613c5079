"""From radiance to counts: a seeded numpy transform that never needs the renderer."""
