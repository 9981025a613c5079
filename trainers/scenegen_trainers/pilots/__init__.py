"""Pilots that are networks, and what the word after ``--pilot`` may mean.

A depth network is given what the camera reported and answers in metres: ``network(counts, previous) -> depth_m``, all
three float32 (n, rows, columns); the frame before the first is the first itself. Scaling, optical flow and whatever
else it wants of the two frames is the network's own business and travels with it.

* `frames` counts in, metres out: what networks are given, and what is made of their answers;
* `checkpoint` torch networks, `onnx` ONNX graphs: sources of depth;
* `box` a source of depth in a process of its own, for one that crashes its process;
* `spec` pilots by name, file or ``module:attribute``.
"""
