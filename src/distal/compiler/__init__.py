"""The compiler: the driver, the linker of prelude functions, and the evaluation of constants."""
