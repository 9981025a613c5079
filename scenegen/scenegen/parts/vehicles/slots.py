"""Surface slots of a vehicle."""

PAINT, BONNET, GLASS, TYRE, WHEEL, UNDERSIDE, EXHAUST, CARGO = range(8)
"""Body, bonnet (the sheet over the engine), windows, tyres, rims and brakes, undertray with grille, pipe, load box."""

SLOTS = 8
