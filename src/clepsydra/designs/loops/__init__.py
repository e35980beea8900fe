"""What the designs of single loops share: pairing, settings, detuning, the controller made."""
