"""Share: common subexpressions computed once; deep expressions split."""
