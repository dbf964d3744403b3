//! Columns of a CSV file by their names.

/// Content of a column. Axes are numbered from 0, and particles as the names number them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Column {
    Time,
    /// Number of the particle of the row.
    Particle,
    /// Computing time of the run (s).
    Seconds,
    /// Coordinate, or velocity along an axis, of one particle or of the row's.
    Of {
        velocity: bool,
        axis: usize,
        particle: Option<usize>,
    },
    Other,
}

impl Column {
    /// Returns the column of a name, which may have a unit after it, as in `x (m)`.
    pub fn of(name: &str) -> Self {
        let name = name.trim().trim_matches('"').to_lowercase();
        let name = name.split_once(" (").map_or(&*name, |(name, _)| name);
        let name = name.split_once(" [").map_or(name, |(name, _)| name).trim();
        match name {
            "t" | "time" | "times" => return Self::Time,
            "particle" | "index" | "id" | "i" => return Self::Particle,
            "seconds" => return Self::Seconds,
            _ => {}
        }
        let (velocity, rest) = match name.strip_prefix('v') {
            Some(rest) => (true, rest),
            None => (false, name),
        };
        let mut letters = rest.chars();
        let axis = letters.next().and_then(|c| "xyz".find(c));
        let Some(axis) = axis else {
            return Self::Other;
        };
        let number = letters.as_str();
        let bare = number
            .strip_prefix('[')
            .and_then(|rest| rest.strip_suffix(']'));
        let bare = bare.unwrap_or_else(|| number.trim_start_matches('_'));
        let particle = match bare.parse() {
            Ok(particle) => Some(particle),
            Err(_) if number.is_empty() => None,
            Err(_) => return Self::Other,
        };
        Self::Of {
            velocity,
            axis,
            particle,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_many_programs_are_understood() {
        let of = |velocity, axis, particle| Column::Of {
            velocity,
            axis,
            particle,
        };
        for (name, column) in [
            ("t", Column::Time),
            (" Time (s) ", Column::Time),
            ("\"particle\"", Column::Particle),
            ("seconds", Column::Seconds),
            ("x", of(false, 0, None)),
            ("vz", of(true, 2, None)),
            ("y12", of(false, 1, Some(12))),
            ("vx_3", of(true, 0, Some(3))),
            ("Z[7]", of(false, 2, Some(7))),
            ("x [m]", of(false, 0, None)),
            ("x0 (m)", of(false, 0, Some(0))),
            ("energy", Column::Other),
            ("xa", Column::Other),
            ("v", Column::Other),
            ("", Column::Other),
            ("frame", Column::Other),
        ] {
            assert_eq!(Column::of(name), column, "{name}");
        }
    }
}
