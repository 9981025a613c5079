"""Networks for a drone's own computer: ONNX graphs, and what they cost."""
