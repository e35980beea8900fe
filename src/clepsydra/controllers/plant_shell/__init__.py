"""The plant shell: a step law around a step law, with what a plant needs beside control."""
