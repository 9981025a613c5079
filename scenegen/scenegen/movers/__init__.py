"""Things that move: rest-pose meshes on seeded routes that repeat for ever, each a pure function of time.

Maps fill `World.movers` with what these return, tuples of `mover.Mover`:

* `drive.drive(lanes, per_100_m, shop, rng, ...)`: vehicles round closed lanes;
* `stroll.stroll(ways, per_100_m, shop, rng, ...)`: people along closed ways, walking or running;
* `play.play(pitch, players, shop, rng, ...)`: players on a pitch;
* `sail.sail(rings, per_km, shop, rng, water=..., ...)` and `sail.anchor(...)`: boats under way, and bobbing ones.

`rounds.there_and_back(line, right_m)` closes an open line. Lines must not cross each other, nor what stands.
"""
