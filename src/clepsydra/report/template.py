"""The templates of the HTML pages; they share one style."""

from __future__ import annotations

from importlib import resources
from typing import Any


def rendered(template: str, **values: Any) -> str:
    """Return a page made from a template of this package.

    Everything from the user's files is escaped; only what is marked as markup, such as pictures,
    which escape their own words, is put in as it is.

    Parameters
    ----------
    template : str
        Name of its file.
    **values
        What it shows; it refuses a name that it is not given.

    Examples
    --------
    >>> "max-width" in rendered("page_style.css.jinja")
    True
    """
    import jinja2

    folder = resources.files("clepsydra.report")
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(lambda name: folder.joinpath(name).read_text("utf-8")),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(template).render(**values)
