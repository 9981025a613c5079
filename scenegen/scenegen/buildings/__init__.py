"""Buildings of all maps: plots, footprints, volumes, walls with windows, roofs and what stands on them."""
