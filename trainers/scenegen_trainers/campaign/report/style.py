"""What this page needs beside the sheet of all pages, and the script that hides kinds of flights on the maps."""

from __future__ import annotations

SHEET = """
.big .small{font-weight:400}
td .small{white-space:nowrap}
.key label{cursor:pointer}
.key input{margin:0 6px 0 0;vertical-align:-1px}
svg.plan{border-radius:6px;background:#10131a;--ground:#10131a;--ink:#e4e8ef;--good:#4fc3a1;--note:#e8b04a;
--bad:#ff5c5c;--violet:#b18cf0}
.flight path{fill:none;stroke-width:2.2;stroke-linejoin:round;opacity:.9}
.flight .ring{fill:none;stroke-width:1.6;opacity:.9}
.flight path.left{stroke-width:1;stroke-dasharray:2 5;opacity:.45}
.flight path.halo{stroke:var(--ground);stroke-width:5.5;opacity:.75}
.flight path.cross{stroke:var(--bad);stroke-width:2.6;opacity:1}
.flight:hover path{stroke-width:3.6;opacity:1}
.scale path{fill:none;stroke:var(--ink);stroke-width:1.6}
.scale text{fill:var(--ink);font-size:20px;text-anchor:middle}
svg.shelf{position:absolute;width:0;height:0}
@media(max-width:640px){.flight path{stroke-width:3.6}.flight .ring{stroke-width:2.6}.scale text{font-size:34px}
.scale path{stroke-width:2.6}}
@media print{.key input{display:none}}
"""
"""Maps are dark by day as by night, so their paths keep the colours of the night."""

SCRIPT = (
    "document.querySelectorAll('.key input').forEach(b=>b.addEventListener('change',()=>"
    "document.querySelectorAll('.flight.'+b.value).forEach(g=>g.style.display=b.checked?'':'none')))"
)
