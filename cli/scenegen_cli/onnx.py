"""``scenegen onnx``: export a trained network as an ONNX graph and measure what it costs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import tyro

from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.errors import InputError
from scenegen_cli.console import note, say, say_json, size, table
from scenegen_cli.parse import HelpShown, parse
from scenegen_cli.teaching import need_torch


@dataclass(frozen=True)
class Onnx:
    """Export networks as ONNX graphs, and print what each costs a drone's computer."""

    checkpoints: Annotated[tuple[Path, ...], tyro.conf.Positional]
    """One model.pt of `scenegen train`, or several; each graph is written beside its checkpoint."""
    threads: int = 1
    """Of torch and onnxruntime."""
    repeats: int = 20
    """Runs of each; the median counts."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    try:
        command = parse(Onnx, "onnx", arguments)
    except HelpShown:
        return 0
    if not command.checkpoints or command.threads < 1 or command.repeats < 1:
        raise InputError("name at least one checkpoint, one thread and one repeat")
    need_torch()
    from scenegen_trainers.deploy.cost import cost_of
    from scenegen_trainers.deploy.graph import onnx_graph, takes_counts
    from scenegen_trainers.models.checkpoint import read_checkpoint

    rows = []
    for path in command.checkpoints:
        checkpoint = read_checkpoint(path)
        graph = onnx_graph(checkpoint)
        out = path.with_suffix(".onnx")
        write_atomic(out, graph)
        cost = cost_of(checkpoint, graph, command.threads, command.repeats)
        flies = takes_counts(checkpoint.network.inputs)
        rows.append((path, out, flies, checkpoint.record.get("model", "?"), cost))
    if command.json:
        say_json(
            [
                {
                    "checkpoint": str(path),
                    "graph": str(out),
                    "from_counts": flies,
                    "model": model,
                    **asdict(cost),
                }
                for path, out, flies, model, cost in rows
            ]
        )
        return 0
    lines = [_HEAD]
    for _, _, _, model, c in rows:
        lines.append(
            (
                str(model),
                f"{c.parameters / 1e6:.2f} M",
                f"{c.macs / 1e9:.3f} G",
                size(c.graph_bytes),
                f"{c.input_ms:.1f}",
                f"{c.torch_ms:.1f}",
                f"{c.onnx_ms:.1f}",
                f"{c.blind_m:.2f} m",
                f"{c.difference_m:.1e} m",
            )
        )
    say(table(lines))
    for _, out, flies, _, _ in rows:
        note(f"{out}{'' if flies else '  takes the embedded image: flow is computed outside'}")
    note(f"milliseconds for one frame, {command.threads} thread(s); metres flown at 22.2 m/s meanwhile")
    return 0


_HEAD = ("model", "parameters", "MACs", "graph", "input ms", "torch ms", "onnx ms", "flown", "torch - onnx")
