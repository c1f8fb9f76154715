"""The compiler: the driver, the linked prelude library, and the evaluation of constants."""
