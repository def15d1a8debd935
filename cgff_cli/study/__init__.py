"""Many solves as one: scenes by methods, suites of cases, rows in order, resumed where a run stopped."""
