"""A process in real time on the wires of a plant: its tags, its loop, its history and its doors."""
