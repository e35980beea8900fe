"""References, headings and names of the text that point elsewhere or stand alone."""

from __future__ import annotations

from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.cross_references import wrong_references
from clepsydra.papers.document import Found

#: Place and the words around, to where that stands of which they speak.
_RIGHT = {
    ("section 3.1", "a PID control structure was designed according to"): "[12]",
    ("section 4", "Q and R matrices tuned manually"): "(97a), (98a)",
}
#: Place and what is called so, to what the rest of the document calls it.
_CALLED = {
    ("section 3.1", "numbers of its subsections"): "3.1.1., 3.1.2., 3.1.3.",
    ("section 3.2", "system of (33) and (34)"): "f_in(t)=const",
    ("(72)", "name of the matrix"): "G_c(s)",
    ("(78)", "end of the integrals"): "t_0 + t_f",
    ("(92), (93)", "names of the matrices"): "A_exp, B_exp",
}


def run() -> Found:
    """Return a row for each wrong reference, heading and name."""
    yield from wrong_references(PRINTED, _RIGHT)
    for key, right in _CALLED.items():
        yield PRINTED[key].stated(right, PRINTED[key].text == right)
    yield PRINTED["(35)", "end of the integral"].remark("t, as 1/(T_i s) of (59) and (76) has it")
