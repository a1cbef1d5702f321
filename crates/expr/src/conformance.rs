//! The cases that every evaluator of expressions is held to.
