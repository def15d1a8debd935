"""Many scenes by several methods: suites of cases, measured one after another, a row per case and method."""
