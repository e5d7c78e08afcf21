"""One evaluation at one commit: shares of right answers by robot and question."""
