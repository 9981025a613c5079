"""Networks in plain torch, one file each, readable from top to bottom."""
