"""What an export can be, for who only lists it: nothing numeric is loaded."""

from clepsydra.deploy.target import TARGETS as TARGETS
from clepsydra.deploy.target import targets_of as targets_of
