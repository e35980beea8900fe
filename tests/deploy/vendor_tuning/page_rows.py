"""What the page on vendors' blocks says of each, made from the blocks themselves."""

FORMS = {"isa": "ISA", "series": "series", "parallel": "parallel"}


def parameter_words(block):
    gain = "%/%" if block.gain_in == "percent" else "as connected"
    units = {"gain": gain, "low limit": "OUT", "high limit": "OUT"}
    return ", ".join(f"{p.name} [{p.unit or units.get(p.kind, '1')}]" for p in block.parameters)


def action_words(block):
    if block.action is not None:
        name, reverse, direct = block.action
        return f"{name}: {reverse} or {direct}"
    return "gain > 0 reverse" if block.sign == "gain" else "gain < 0 reverse"


def filter_words(block):
    if isinstance(block.derivative_filter, float):
        return f"Td/{block.derivative_filter:g}"
    return {"settable": "yes", "none": "none", "unpublished": "not published"}[
        block.derivative_filter
    ]


def table_row(block):
    weights = " or ".join(f"{weight:g}" for weight in block.weights) or "any"
    on = " or ".join(block.derivative_on) or "not confirmed"
    cells = (
        block.title, FORMS[block.form], parameter_words(block), action_words(block), weights, on,
        filter_words(block) if block.derivative_on else "not confirmed",
    )  # fmt: skip
    return f"| {' | '.join(cells)} |"


def entry(block):
    lines = [f"**{block.title}**: {block.equation}."]
    lines.append(f"Scaling: {block.scaling}. Anti-windup: {block.anti_windup}.")
    open_points = (*block.not_confirmed, *block.not_confirmed_of_derivative)
    if open_points:
        lines.append(f"Not confirmed: {'; '.join(open_points)}.")
    lines.append(f"Source: {'; '.join(block.sources)}.")
    return " ".join(lines)
