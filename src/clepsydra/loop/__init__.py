"""Process, controller and scenario, joined to one closed loop, and its run."""
