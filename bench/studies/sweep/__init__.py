"""Scenarios in numbers: truth and identification side by side."""
