"""Charts as values, made once from results, whatever draws them."""
