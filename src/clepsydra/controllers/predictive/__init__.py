"""Model predictive control: moves over a horizon, planned anew in every sample."""
