"""The same samples for other frameworks: PyTorch, Lightning, WebDataset. Each module imports its own library."""
