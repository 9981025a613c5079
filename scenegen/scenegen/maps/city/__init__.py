"""City: an irregular street network, blocks, buildings, a park."""
