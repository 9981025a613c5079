"""Vehicles: cars, vans, buses and trucks, parked or driven."""
