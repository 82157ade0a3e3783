//! What people look at: SVG charts and self-contained HTML reports.
