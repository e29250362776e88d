"""Statistics of replicates: differences with errors, their p-values, equivalence, power, and how runs part."""
