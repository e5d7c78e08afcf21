"""Evaluation of the program at one commit: shares of right answers by robot and question."""
