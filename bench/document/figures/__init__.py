"""Results as figures, on the screen's page and for papers."""
