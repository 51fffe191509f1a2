"""The look of the comparison page: a neutral dark ground, so that images keep their colours."""

CSS = """
:root { color-scheme: dark; --ground: #161618; --raised: #1f1f22; --line: #343438;
  --ink: #e8e8e6; --faint: #a2a2a6; --bright: #6ee79a; --dark: #ff7a6e; --accent: #9cc4ff; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--ink);
  font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", sans-serif; }
main { max-width: 1440px; margin: 0 auto; padding: 2rem clamp(1rem, 4vw, 3rem) 4rem; }
h1 { font-size: clamp(1.5rem, 4vw, 2.25rem); line-height: 1.2; font-weight: 650; margin: 0; }
h2 { font-size: 1.25rem; font-weight: 600; margin: 3rem 0 .25rem; }
h3 { font-size: 1rem; font-weight: 600; margin: 1.5rem 0 .5rem; }
p { max-width: 70ch; margin: .5rem 0; }
.faint, figcaption, th, dt { color: var(--faint); }
.facts { display: flex; flex-wrap: wrap; gap: .25rem 2rem; margin: 1rem 0 0; }
.facts div { display: flex; gap: .5rem; }
dd { margin: 0; font-variant-numeric: tabular-nums; }
.scroll { overflow-x: auto; margin: 1rem 0; border: 1px solid var(--line); border-radius: 8px; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; }
th, td { padding: .45rem .8rem; text-align: right; white-space: nowrap;
  font-variant-numeric: tabular-nums; }
th { font-weight: 500; }
thead th { border-bottom: 1px solid var(--line); vertical-align: bottom; }
tbody tr + tr > * { border-top: 1px solid #29292d; }
th:first-child, td:first-child { text-align: left; position: sticky; left: 0;
  background: var(--ground); }
tbody th { color: var(--ink); }
.row, .lead { display: grid; gap: 1rem; margin: 1rem 0; grid-template-columns: minmax(0, 1fr); }
.lead .scroll { margin: 0; align-self: start; }
@media (min-width: 760px) {
  .row { grid-template-columns: repeat(3, minmax(0, 1fr)); }
  .lead { grid-template-columns: minmax(0, 1fr) minmax(0, 2fr); }
}
figure { margin: 0; min-width: 0; }
figure img { display: block; width: 100%; height: auto; border-radius: 4px; background: #000; }
figure img[data-truth] { cursor: pointer; touch-action: manipulation; user-select: none;
  -webkit-user-select: none; -webkit-touch-callout: none; }
figure img:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
figcaption { font-size: .85rem; padding: .4rem 0 0; }
figcaption b { color: var(--ink); font-weight: 600; }
.failed { border: 1px solid var(--dark); border-radius: 8px; padding: .75rem 1rem; margin: 1rem 0;
  overflow-wrap: anywhere; }
.swatch { display: inline-block; width: .8em; height: .8em; border-radius: 2px;
  vertical-align: -.05em; }
pre { background: var(--raised); border: 1px solid var(--line); border-radius: 8px;
  padding: 1rem; overflow-x: auto; font-size: .85rem; }
"""

SCRIPT = """
for (const img of document.querySelectorAll("img[data-truth]")) {
  const own = img.src, truth = document.getElementById(img.dataset.truth).src;
  const show = (is) => { img.src = is ? truth : own; };
  img.addEventListener("pointerdown", () => show(true));
  for (const end of ["pointerup", "pointerleave", "pointercancel", "blur"])
    img.addEventListener(end, () => show(false));
  img.addEventListener("keydown", (e) => {
    if (e.key === " ") { e.preventDefault(); show(true); }
  });
  img.addEventListener("keyup", () => show(false));
  img.addEventListener("contextmenu", (e) => e.preventDefault());
}
"""
