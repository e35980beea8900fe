"""What an export can be, a file each."""
