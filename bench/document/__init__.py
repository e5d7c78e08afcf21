"""Tables as values, made once from results, with one renderer each for terminal, Markdown, pages and data frames."""
