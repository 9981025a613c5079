"""Parts that maps share: plants, vehicles, people, boats, fixtures."""
