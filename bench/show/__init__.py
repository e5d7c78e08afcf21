"""What people look at: tables, figures, and recordings for the Rerun viewer."""
