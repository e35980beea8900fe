"""The shapes of tanks: level, area and volume of each, and the way back from volume to level."""
