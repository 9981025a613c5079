"""The style sheet of all pages. Colours are variables with a value by day and one by night."""

from __future__ import annotations

SERIES = tuple(f"var(--series-{k})" for k in range(1, 7))
"""Colours of lines and bars that stand side by side; readable with the common colour blindnesses."""

GOOD, NOTE, BAD, FAINT, INK = (f"var(--{name})" for name in ("good", "note", "bad", "faint", "ink"))

_DAY = (
    "--ground:#f7f6f3;--card:#fff;--line:#e1dfd9;--hair:#edebe6;--ink:#1c2126;--soft:#4b545e;--faint:#66707b;"
    "--link:#1f5fbf;--good:#1a7a53;--note:#966000;--bad:#c02f2b;--violet:#7350bd;--bar:#eceae4;--span:#1f5fbf1f;--shade:#1c212622;"
    "--series-1:#2a6fc9;--series-2:#d9742a;--series-3:#219071;--series-4:#8457c8;--series-5:#b63d6b;--series-6:#7d8794"
)
_NIGHT = (
    "--ground:#10131a;--card:#161b24;--line:#262d39;--hair:#1d232d;--ink:#e6eaf0;--soft:#b9c1cd;--faint:#8893a2;"
    "--link:#7db7ff;--good:#4fc3a1;--note:#e8b04a;--bad:#ff6f6a;--violet:#b18cf0;--bar:#222834;--span:#7db7ff26;--shade:#e6eaf022;"
    "--series-1:#7db7ff;--series-2:#ffb35c;--series-3:#4fc3a1;--series-4:#b18cf0;--series-5:#f589ae;--series-6:#97a3b3"
)

SHEET = (
    ":root{color-scheme:light dark;" + _DAY + "}"
    "@media(prefers-color-scheme:dark){:root{" + _NIGHT + "}}"
    """
*{box-sizing:border-box}
html{-webkit-text-size-adjust:100%}
body{margin:0;background:var(--ground);color:var(--ink);font:15px/1.55 system-ui,-apple-system,"Segoe UI",sans-serif}
main{max-width:1240px;margin:0 auto;padding:40px 28px 80px}
h1{font-size:30px;line-height:1.2;font-weight:650;letter-spacing:-.02em;margin:0;overflow-wrap:anywhere}
h2{font-size:20px;line-height:1.3;font-weight:620;letter-spacing:-.01em;margin:54px 0 6px}
h3{font-size:14px;font-weight:600;margin:0 0 8px;color:var(--soft)}
p{margin:8px 0;max-width:78ch}
p.lead{color:var(--faint);margin:8px 0 0;max-width:none}
a{color:var(--link)}
:focus-visible{outline:2px solid var(--link);outline-offset:2px}
nav{position:sticky;top:0;z-index:1;background:var(--ground);border-bottom:1px solid var(--line);margin:22px 0 0;
display:flex;gap:4px 20px;overflow-x:auto;padding:10px 0;font-size:13.5px;white-space:nowrap}
nav a{color:var(--soft);text-decoration:none}
nav a:focus-visible{outline-offset:-1px}
nav a:hover{color:var(--link);text-decoration:underline}
[id]{scroll-margin-top:58px}
code,pre{font:12.5px/1.5 ui-monospace,SFMono-Regular,Menlo,Consolas,monospace;overflow-wrap:anywhere}
pre{background:var(--card);border:1px solid var(--line);border-radius:8px;padding:14px;overflow:auto}
.small{color:var(--faint);font-size:12.5px}
p.small{max-width:100ch}
.scroll{overflow-x:auto;margin:12px 0;background:
linear-gradient(90deg,var(--ground) 40%,transparent) 0 0/36px 100% no-repeat local,
linear-gradient(-90deg,var(--ground) 40%,transparent) 100% 0/36px 100% no-repeat local,
linear-gradient(90deg,var(--shade),transparent) 0 0/12px 100% no-repeat scroll,
linear-gradient(-90deg,var(--shade),transparent) 100% 0/12px 100% no-repeat scroll}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}
th{font-weight:500;color:var(--faint);text-align:left;font-size:12.5px;padding:6px 16px 6px 0;vertical-align:bottom;
border-bottom:1px solid var(--line)}
thead td{border-bottom-color:var(--line)}
td{padding:7px 16px 7px 0;border-bottom:1px solid var(--hair);vertical-align:middle}
th:last-child,td:last-child{padding-right:0}
td.number,th.number{text-align:right}td.number{white-space:nowrap}
td.wide{width:40%}
td.name{white-space:nowrap}
td.big{font-size:19px;font-weight:600;white-space:nowrap}
table.dense{font-size:13.5px}
table.dense :is(th,td):not(:last-child){padding-right:11px}
.good{color:var(--good)}.note{color:var(--note)}.bad{color:var(--bad)}.faint{color:var(--faint)}
.cards{display:grid;gap:18px;margin:16px 0;
grid-template-columns:repeat(auto-fill,minmax(min(var(--least,330px),100%),1fr))}
.card{--ground:var(--card);background:var(--card);border:1px solid var(--line);border-radius:10px;padding:16px;
min-width:0}
.card .figure{font-size:24px;font-weight:620;letter-spacing:-.02em;line-height:1.2}
.key{display:flex;gap:6px 18px;flex-wrap:wrap;margin:8px 0 12px;color:var(--soft);font-size:13px}
.key i,.swatch{display:inline-block;width:11px;height:11px;border-radius:3px;margin-right:6px;vertical-align:-1px;
box-shadow:inset 0 0 0 1px var(--line)}
details{margin-top:12px}
summary{cursor:pointer;color:var(--soft)}
img{display:block;max-width:100%;height:auto;border-radius:4px}
svg{display:block;width:100%}
svg text{fill:var(--faint);font:11px system-ui,sans-serif}
svg text.axis{fill:var(--soft);text-anchor:middle}
svg .grid{stroke:var(--line);stroke-width:1;fill:none}
svg .x{text-anchor:middle}svg .y{text-anchor:end}svg text.up{fill:var(--soft)}
svg .line{fill:none;stroke-width:2;stroke-linejoin:round}
svg .band{opacity:.18}
svg .whisker{stroke-width:1.2;opacity:.75}
svg.bar{height:12px;min-width:120px;border-radius:3px}
.card svg.bar{min-width:36px}
@media(max-width:640px){main{padding:24px 16px 60px}h1{font-size:24px}h2{margin-top:42px}
th,td{padding-right:12px}td:first-child{min-width:7em}td.name:first-child{white-space:normal}
td.wide svg.bar{min-width:36px}}
@media print,(max-width:640px){svg.large text{font-size:16px}svg.large .x{transform:translateY(3px)}}
@page{margin:14mm}
@media print{*{print-color-adjust:exact;-webkit-print-color-adjust:exact}body{font-size:12px}
main{max-width:none;padding:0}nav{display:none}h2{margin-top:28px}h2,h3,.head,.said,.key{break-after:avoid}
.card,.said,tr,svg,img{break-inside:avoid}.key{font-size:11px}svg.bar{min-width:36px}
.scroll{overflow:visible;background:none}
.cards{gap:12px;grid-template-columns:repeat(auto-fill,minmax(min(var(--least,330px),46%),1fr))}.card{padding:12px}
table,table.dense{font-size:11px}th,td{padding:4px 10px 4px 0}
details:not(:has(pre,tr:nth-child(40)))::details-content{content-visibility:visible;block-size:auto}}
"""
    "@media print{:root{color-scheme:light;" + _DAY + ";--ground:#fff}}"
)
