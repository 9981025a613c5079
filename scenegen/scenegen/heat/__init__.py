"""Surface temperatures from a periodic heat balance."""
