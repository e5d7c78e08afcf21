"""Drive gains and dynamic parameters from recordings (Briot and Gautier 2012, section 3)."""
