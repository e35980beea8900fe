"""What the designs by states share: gains, poles, observers, the controller made."""
