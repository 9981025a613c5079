"""The page of a campaign: figures, maps of paths and crash sites, charts of sweeps; one file that needs no other."""
