"""Systematic identification model of a closed-loop robot (Briot and Gautier 2012, equations 1-8)."""
