"""The style sheet of the page, and the one line of script that hides kinds of flights on the maps."""

from __future__ import annotations

from scenegen_trainers.campaign.report.charts import STYLE as CHARTS

SHEET = (
    """
:root{color-scheme:dark}
*{box-sizing:border-box}
body{margin:0;background:#10131a;color:#e4e8ef;font:15px/1.5 system-ui,-apple-system,"Segoe UI",sans-serif}
main{max-width:1240px;margin:0 auto;padding:40px 28px 80px}
h1{font-size:30px;font-weight:650;letter-spacing:-.02em;margin:0}
h2{font-size:18px;font-weight:600;margin:46px 0 14px}
h3{font-size:14px;font-weight:600;margin:0 0 8px;color:#c3cad6}
p.lead{color:#8b94a3;margin:6px 0 0}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}
th{font-weight:500;color:#8b94a3;text-align:left;font-size:12px;padding:6px 12px 6px 0;border-bottom:1px solid #262c37}
td{padding:8px 12px 8px 0;border-bottom:1px solid #1b2029;vertical-align:middle}
td.number,th.number{text-align:right}
td.wide{width:40%}
td.big{font-size:19px;font-weight:600;white-space:nowrap}
td .small,.small{color:#8b94a3;font-size:12px;white-space:nowrap}
svg.bar{display:block;width:100%;min-width:150px;height:12px;border-radius:3px}
.cards{display:grid;grid-template-columns:repeat(auto-fill,minmax(480px,1fr));gap:22px}
.card{background:#161b24;border:1px solid #232a36;border-radius:10px;padding:16px}
svg.plan{display:block;width:100%;border-radius:6px;background:#10131a}
.flight path{fill:none;stroke-width:1.7;stroke-linejoin:round;opacity:.85}
.flight .ring{fill:none;stroke-width:1.4;opacity:.8}
.flight path.left{stroke-width:1;stroke-dasharray:2 5;opacity:.45}
.flight path.halo{stroke:#10131a;stroke-width:5.5;opacity:.75}
.flight path.cross{stroke:#ff5c5c;stroke-width:2.6;opacity:1}
.flight:hover path{stroke-width:3.2;opacity:1}
.scale path{fill:none;stroke:#e4e8ef;stroke-width:1.6}
.scale text{fill:#e4e8ef;font:15px system-ui,sans-serif;text-anchor:middle}
.key{display:flex;gap:18px;flex-wrap:wrap;margin:0 0 14px;color:#c3cad6;font-size:13px}
.key label{cursor:pointer}
.key i{display:inline-block;width:11px;height:11px;border-radius:3px;margin:0 6px 0 4px;vertical-align:-1px}
details{margin-top:12px}
summary{cursor:pointer;color:#c3cad6}
pre{background:#161b24;border:1px solid #232a36;border-radius:8px;padding:14px;overflow:auto;font-size:12px}
a{color:#7db7ff}
"""
    + CHARTS
)

SCRIPT = (
    "document.querySelectorAll('.key input').forEach(b=>b.addEventListener('change',()=>"
    "document.querySelectorAll('.flight.'+b.value).forEach(g=>g.style.display=b.checked?'':'none')))"
)
