//! Smoothed-particle hydrodynamics for metals that yield, flow and break.
