"""Tables as values, made once from results; terminal, Markdown, pages and data frames each have one renderer."""
