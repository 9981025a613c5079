"""Planners: `five_section` and `waypoint` steer by the depth map, `straight` by nothing but the goal."""
