"""The world: what stands there and how warm it is. Knows nothing of any renderer."""
