//! Flutter stability: K, KE, PK and g methods, tracking, crossings, matched points.
