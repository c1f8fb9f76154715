"""Large smooth unions: lists of the members that matter, one for each cell of a grid."""
