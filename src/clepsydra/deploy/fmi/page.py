"""The page of documentation inside an FMU."""

from __future__ import annotations

from html import escape

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.deploy.fmi.model import FmuModel, FmuVariable
from clepsydra.deploy.printing.heading import written_with

_STYLE = (
    "body{font-family:sans-serif;max-width:60em;margin:2em auto;padding:0 1em;line-height:1.4}"
    "table{border-collapse:collapse}td,th{border-bottom:1px solid #bbb;padding:.2em .7em;"
    "text-align:left}td.number{text-align:right;font-variant-numeric:tabular-nums}"
)
_GROUPS = (
    ("input", "Inputs"), ("output", "Outputs"), ("parameter", "Parameters"), ("local", "State"),
)  # fmt: skip


def documentation_page(model: FmuModel) -> str:
    """Return documentation/index.html: what it is, how it steps, and every variable."""
    parts = [
        "<!DOCTYPE html>",
        '<html lang="en"><head><meta charset="utf-8">',
        f"<title>{escape(model.title)}</title><style>{_STYLE}</style></head><body>",
        f"<h1>{escape(model.title)}</h1>",
        *(f"<p>{escape(line)}</p>" for line in model.origin.lines()),
        f"<p>{escape(_stepping(model))}</p>",
        f"<p>Written by {escape(written_with())}; digest {model.digest}. The folder sources "
        "has the C that the binary was built from.</p>",
    ]
    for causality, title in _GROUPS:
        group = [v for v in model.variables if v.causality == causality]
        if group:
            parts.append(f"<h2>{title}</h2>")
            parts += _table(model, group)
    return "\n".join([*parts, "</body></html>", ""])


def _stepping(model: FmuModel) -> str:
    if model.exchange:
        return "The importer integrates it: model exchange."
    if model.scans:
        return (
            f"A scan runs every {model.step:.12g} s, at the start of the communication step in "
            "which it falls due; the outputs hold until the next one."
        )
    return (
        f"It is integrated in steps of {model.step:.12g} s, and in a part of one where a "
        "communication step begins or ends between two of them; inputs are held over a "
        "communication step."
    )


def _table(model: FmuModel, group: list[FmuVariable]) -> list[str]:
    rows = ["<table><tr><th>name</th><th>start</th><th>unit</th><th>range</th><th>what</th></tr>"]
    for variable in group:
        signal = variable.signal
        source = model.origin.source_of(signal) if variable.causality == "parameter" else ""
        words = "; ".join(filter(None, (signal.description, source)))
        start = _shown(signal.initial, signal) if variable.settable else ""
        limits = f"{_shown(signal.low, signal)} … {_shown(signal.high, signal)}"
        rows.append(
            f'<tr><td>{escape(variable.name)}</td><td class="number">{start}</td>'
            f"<td>{escape(signal.shown_unit if signal.kind == 'real' else signal.kind)}</td>"
            f"<td>{limits if 'inf' not in limits else ''}</td><td>{escape(words)}</td></tr>"
        )
    return [*rows, "</table>"]


def _shown(value: float, signal: Signal) -> str:
    return f"{from_si(value, signal.unit, signal.shown_unit):.7g}"
