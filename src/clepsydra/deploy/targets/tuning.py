"""PID settings in the forms and units of the vendors' own blocks."""

from __future__ import annotations

from clepsydra.deploy.target import TARGETS, Delivery, ExportedFiles, Options, Target


def _controller(delivery: Delivery, options: Options) -> ExportedFiles:
    from clepsydra.deploy.exportable import exportable_name
    from clepsydra.deploy.vendor_tuning.translation import translate

    controller, process = delivery.controller, delivery.point.process
    found = translate(controller, process, delivery.scenario())
    name = f"{exportable_name(process, controller)}_tuning.md"
    return ExportedFiles(
        {name: found.as_markdown().encode()},
        found.as_dict(),
        "enter the numbers of your block, with its switches, from the file.",
        answer=found.answer(),
    )


TARGETS.add(
    "tuning", Target(5, "PID settings in the vendors' forms and units", _controller, shelled=False)
)
