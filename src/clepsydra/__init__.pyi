# What `import clepsydra as cl` publishes: read by editors and type checkers for its types, and by
# base/lazy.py for the module that each name is loaded from when it is first used.

from clepsydra.base.errors import ClepsydraError as ClepsydraError
from clepsydra.base.errors import InputError as InputError
from clepsydra.base.signal import Signal as Signal
from clepsydra.controllers.own_law import load_law as load_law
from clepsydra.controllers.pid_form import PidForm as PidForm
from clepsydra.controllers.python_law import PythonLaw as PythonLaw
from clepsydra.controllers.python_law import python_law as python_law
from clepsydra.designs.applicability import NotApplicable as NotApplicable
from clepsydra.engine.kernel import Kernel as Kernel
from clepsydra.interface import design as design
from clepsydra.interface.analyse import analyse as analyse
from clepsydra.interface.analyse import margins as margins
from clepsydra.interface.analyse import poles as poles
from clepsydra.interface.analyse import relative_gains as relative_gains
from clepsydra.interface.analyse import zeros as zeros
from clepsydra.interface.analysis import Analysis as Analysis
from clepsydra.interface.catalogue import catalogue as catalogue
from clepsydra.interface.controller import Controller as Controller
from clepsydra.interface.events import Event as Event
from clepsydra.interface.events import disturbance as disturbance
from clepsydra.interface.events import profile as profile
from clepsydra.interface.events import ramp as ramp
from clepsydra.interface.events import step as step
from clepsydra.interface.export import Exported as Exported
from clepsydra.interface.export import export as export
from clepsydra.interface.identify import FittedPlant as FittedPlant
from clepsydra.interface.identify import Identification as Identification
from clepsydra.interface.identify import identify as identify
from clepsydra.interface.new import new_process as new_process
from clepsydra.interface.new import new_study as new_study
from clepsydra.interface.papers import Audit as Audit
from clepsydra.interface.papers import audit as audit
from clepsydra.interface.plant import Plant as Plant
from clepsydra.interface.plant import load as load
from clepsydra.interface.run import OpenLoopRun as OpenLoopRun
from clepsydra.interface.run import Run as Run
from clepsydra.interface.scores import Scores as Scores
from clepsydra.interface.simulate import simulate as simulate
from clepsydra.interface.study import Candidate as Candidate
from clepsydra.interface.study import Study as Study
from clepsydra.interface.study import study as study
from clepsydra.interface.tune import TunedController as TunedController
from clepsydra.interface.tune import tune as tune
from clepsydra.interface.verify import Proof as Proof
from clepsydra.interface.verify import verify as verify
from clepsydra.linear.equilibrium import NoEquilibrium as NoEquilibrium
from clepsydra.linear.linear_model import LinearModel as LinearModel
from clepsydra.process.element import Connection as Connection
from clepsydra.process.element import Element as Element
from clepsydra.process.element import Flow as Flow
from clepsydra.process.outlet import Outlet as Outlet
from clepsydra.program.reader import program_of as program_of
from clepsydra.program.step_law import StepLaw as StepLaw

__version__: str
