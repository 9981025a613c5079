"""Drone and world in closed loop: a batch of flights shares a world, an hour and a clock and advances together.

One step, from outside (nothing of the renderer is in here; depth or counts are handed in):

    arena = Arena(obstacles, clock, missions, knobs)
    while arena.flying:
        images = ... of arena.poses() at arena.world_time_s
        seen = arena.observe(camera, depth_m=images)
        arena.advance(ask(pilot, seen, knobs.patience_s))
    outcomes = arena.outcomes()

* `pilot` what a pilot is given and what it answers; `pilots` depth source and planner put together;
  `asking` a pilot that fails costs its flight, never the campaign;
* `drone` what a command does to a quadrotor in `wind`; `contact` what it touches on the way;
* `missions` where flights start and where they want to go; `outcome` how they ended; `arena` all of it.
"""
