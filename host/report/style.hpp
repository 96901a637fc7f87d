// The report's style sheet: dark on light, system fonts, two columns that become one on paper.
#pragma once

namespace raysteer::host::report {

inline constexpr const char* kStyle = R"css(
:root { --ink: #20303c; --soft: #5b6b77; --line: #d5dce2; --good: #1a7f45; --usable: #b26a00; --redo: #b3261e; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 2rem 1.5rem 4rem; max-width: 64rem; color: var(--ink); background: #fff;
  font: 15px/1.5 system-ui, "Segoe UI", Roboto, "Helvetica Neue", "DejaVu Sans", sans-serif; }
header { border-left: 6px solid var(--soft); padding: 0.2rem 0 0.2rem 1.4rem; margin-bottom: 1.6rem; }
header.good { border-color: var(--good); } header.usable { border-color: var(--usable); }
header.redo { border-color: var(--redo); }
.verdict { margin: 0; font-weight: 700; font-size: 0.85rem; letter-spacing: 0.12em; text-transform: uppercase;
  color: var(--soft); }
.good .verdict { color: var(--good); } .usable .verdict { color: var(--usable); } .redo .verdict { color: var(--redo); }
h1 { font-size: 1.5rem; line-height: 1.3; margin: 0.2rem 0 0.6rem; font-weight: 600; }
h2 { font-size: 1.15rem; margin: 2.4rem 0 0.8rem; padding-bottom: 0.3rem; border-bottom: 1px solid var(--line); }
h2 small { font-weight: 400; color: var(--soft); }
h3 { font-size: 0.95rem; margin: 0.4rem 0 0.3rem; }
header h3 { margin: 0.7rem 0 0.1rem; } header ul { margin: 0; padding-left: 1.2rem; }
.numbers { display: grid; grid-template-columns: repeat(auto-fill, minmax(9.5rem, 1fr)); gap: 0.8rem; margin: 0; padding: 0; list-style: none; }
.numbers li { border: 1px solid var(--line); border-radius: 6px; padding: 0.55rem 0.8rem; }
.numbers b { display: block; font-size: 1.3rem; font-weight: 600; font-variant-numeric: tabular-nums; white-space: nowrap; }
.numbers span { color: var(--soft); font-size: 0.82rem; line-height: 1.3; display: block; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(21rem, 1fr)); gap: 1.4rem 2rem; }
figure { margin: 0; break-inside: avoid; } figure.wide { grid-column: 1 / -1; }
figcaption { color: var(--soft); font-size: 0.82rem; line-height: 1.4; margin-top: 0.2rem; }
svg { display: block; width: 100%; height: auto; font-size: 11px; fill: var(--ink); }
svg text { font-family: inherit; } svg .cell { font-size: 9.5px; } svg .unit { fill: var(--soft); }
svg .axis { stroke: var(--soft); } svg .grid { stroke: var(--line); } svg .frame { fill: none; stroke: var(--soft); }
svg .zero { stroke: var(--ink); stroke-dasharray: 3 3; }
svg .arrow { fill: none; stroke: #0b4f8a; stroke-width: 0.8; } svg .dropped { fill: none; stroke: #d02c1f; stroke-width: 1; }
svg .ring { fill: #fff; stroke: #20303c; stroke-width: 1.4; } svg .cross { fill: none; stroke: #1a7f45; stroke-width: 2; }
svg .under { stroke: #fff; stroke-width: 4; }
svg .station { fill: none; stroke: #20303c; stroke-width: 1.3; } svg .bad { stroke: #b3261e; stroke-width: 2; }
svg .vector { fill: none; stroke: #d55e00; stroke-width: 1.4; }
svg .halo { paint-order: stroke; stroke: #fff; stroke-width: 3px; stroke-linejoin: round; }
svg .measure { stroke-width: 2; }
img { max-width: 100%; display: block; border: 1px solid var(--line); border-radius: 4px; }
figcaption + table, figure + table { margin-top: 0.7rem; } table { border-collapse: collapse; font-size: 0.88rem; font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 600; color: var(--soft); border-bottom: 1px solid var(--soft); }
th, td { padding: 0.18rem 1.4rem 0.18rem 0; vertical-align: top; } td { border-bottom: 1px solid var(--line); }
td.n, th.n { text-align: right; } tr.unused td { color: var(--soft); } tr.unused td.why { color: var(--redo); }
tr.chosen td { font-weight: 600; } td.bad { color: var(--redo); font-weight: 600; }
.columns { display: grid; grid-template-columns: repeat(auto-fit, minmax(19rem, 1fr)); gap: 0 2.5rem; align-items: start; }
footer { margin-top: 3rem; padding-top: 0.8rem; border-top: 1px solid var(--line); color: var(--soft); font-size: 0.82rem; }
@media print { body { padding: 0; max-width: none; font-size: 10pt; } h2 { break-after: avoid; }
  .figures { grid-template-columns: 1fr 1fr; } tr { break-inside: avoid; } }
)css";

}  // namespace raysteer::host::report
