"""The page of a running rig: its operator's station in a browser."""
