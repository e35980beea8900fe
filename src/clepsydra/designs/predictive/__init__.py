"""What a predictive controller is made of: its horizon, its disturbances, and how bold it is."""
