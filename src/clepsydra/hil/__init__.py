"""Hardware in the loop: exported controllers at work as a soft PLC on the wires of a rig."""
