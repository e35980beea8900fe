"""What a reader must know about a loop before and after it is simulated, one kind a file."""
