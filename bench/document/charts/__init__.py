"""Charts as values, made once from results, independent of what draws them."""
