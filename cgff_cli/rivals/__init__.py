"""Other ways to find a form, from the same start and judged by the same residual, for comparison."""
