//! Runs of a few seconds whose answer is known: from theory, from symmetry, or from another way to compute the same.

mod adaptive;
mod approach;
mod audit;
mod combinations;
mod conservation;
mod contact;
mod elastic_modes;
mod external_forces;
mod facets;
mod facets_on_walls;
mod failure;
mod heat;
mod homogeneous;
mod hyperelastic;
mod numerical_work;
mod oracle;
mod persist;
mod precision;
mod renewal;
mod sections;
mod self_contact;
mod setup;
mod spall;
mod symmetry;
mod thin;
mod two_ways;
