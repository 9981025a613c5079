"""Where the camera goes: trajectories and the clearance that keeps them collision-free."""
