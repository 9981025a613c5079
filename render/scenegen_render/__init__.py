"""What a camera receives: radiance, depth, labels, counts."""
