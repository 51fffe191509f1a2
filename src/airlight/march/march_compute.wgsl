//! use march_ray
