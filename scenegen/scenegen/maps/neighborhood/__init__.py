"""The neighborhood: detached houses with gardens along curved streets."""
