"""Laws that no catalogue has, found from what a model leaves."""
