"""What surfaces are made of: the measured table and the palette a world draws from it."""
