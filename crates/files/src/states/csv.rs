//! CSV: a row for each time, with columns for each particle; or a row for each time and particle.
//! Columns are found by their names.

use super::build::States;

/// Names that are understood.
const NAMES: &str = "t or time, and x, y, z in rows of one particle each, or x0, y0, z0, x1, ... in a row for each \
                     time; velocities are vx, vy, vz, or vx0, ...";

/// Separators of columns; a file without any of them separates by spaces.
const SEPARATORS: [char; 3] = [',', ';', '\t'];

/// Reads states of that many particles.
///
/// # Errors
/// The first line has no names that are understood, or a row does not fit: with its line.
pub fn read(text: &str, particles: usize) -> Result<States, String> {
    let lines = text.lines().enumerate().map(|(k, line)| (k + 1, line.trim()));
    let mut lines = lines.filter(|(_, line)| !line.is_empty());
    let (_, head) = lines.next().ok_or("it is empty")?;
    // NumPy's savetxt begins the line of names with #.
    let head = head.trim_start_matches(['#', ' ']);
    let separator = SEPARATORS.into_iter().find(|c| head.contains(*c));
    let columns: Vec<_> = split(head, separator).map(Column::of).collect();
    let mut layout = Layout::of(&columns, particles)?;
    let mut raw = States::default();
    // Rows of one particle each, of the time at the end.
    let mut seen: Vec<bool> = vec![];
    for (line, row) in lines.filter(|(_, line)| !line.starts_with('#')) {
        let wrong = |why: String| format!("line {line}: {why}");
        let cells: Vec<_> = split(row, separator).collect();
        if cells.len() != columns.len() {
            return Err(wrong(format!(
                "it has {}, and the first line names {}",
                counted(cells.len(), "column"),
                columns.len()
            )));
        }
        let row = CsvRow { columns: &columns, cells: &cells };
        let time = row.number(Column::Time).map_err(wrong)?;
        raw.digits[0].add(row.cell(Column::Time).unwrap_or_default());
        let is_new = raw.times.last().is_none_or(|last| *last != time);
        if is_new || layout.wide {
            layout.check_group(&seen, &raw).map_err(wrong)?;
            seen = vec![layout.wide; particles];
            raw.times.push(time);
            raw.positions.push(vec![0.0; 3 * particles]);
            if layout.velocities {
                let velocities = raw.velocities.get_or_insert_default();
                velocities.push(vec![0.0; 3 * particles]);
            }
        }
        if let Some(seconds) = row.cell(Column::Seconds).filter(|cell| !cell.is_empty()) {
            raw.seconds = Some(number(seconds).map_err(wrong)?);
        }
        let own = if layout.wide {
            None
        } else {
            Some(layout.particle(&row, &raw, &mut seen).map_err(wrong)?)
        };
        for (column, cell) in columns.iter().zip(&cells) {
            let &Column::Of { velocity, axis, particle } = column else {
                continue;
            };
            let i = own.unwrap_or_else(|| particle.unwrap_or_default() - layout.first);
            let rows = if velocity {
                raw.velocities.as_mut()
            } else {
                raw.digits[1].add(cell);
                Some(&mut raw.positions)
            };
            if let Some(row) = rows.and_then(|rows| rows.last_mut()) {
                row[axis * particles + i] = number(cell).map_err(wrong)?;
            }
        }
    }
    layout.check_group(&seen, &raw)?;
    Ok(raw)
}

/// Splits a line into its cells.
fn split(line: &str, separator: Option<char>) -> Box<dyn Iterator<Item = &str> + '_> {
    match separator {
        Some(c) => Box::new(line.split(c).map(str::trim)),
        None => Box::new(line.split_ascii_whitespace()),
    }
}

/// Reads a number; NaN and infinities too, which a run that blew up has.
fn number(cell: &str) -> Result<f64, String> {
    cell.parse().map_err(|_| {
        let point = cell.replacen(',', ".", 1);
        if point != cell && point.parse::<f64>().is_ok() {
            format!("{cell} has a decimal comma: write {point}")
        } else if cell.is_empty() {
            "a number is missing".into()
        } else {
            format!("`{cell}` is no number")
        }
    })
}

/// Returns a number of things in words.
fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// A row with the columns of its cells.
struct CsvRow<'a> {
    columns: &'a [Column],
    cells: &'a [&'a str],
}

impl CsvRow<'_> {
    fn cell(&self, column: Column) -> Option<&str> {
        let at = self.columns.iter().position(|c| *c == column)?;
        self.cells.get(at).copied()
    }

    fn number(&self, column: Column) -> Result<f64, String> {
        number(self.cell(column).unwrap_or_default())
    }
}

/// How rows hold the particles.
struct Layout {
    /// Whether a row holds all particles.
    wide: bool,
    /// Whether there are velocities.
    velocities: bool,
    /// Whether a column numbers the particles of rows.
    numbered: bool,
    /// Number of the first particle in the names, 0 or 1.
    first: usize,
    particles: usize,
}

impl Layout {
    /// Returns the layout of columns, for that many particles.
    fn of(columns: &[Column], particles: usize) -> Result<Self, String> {
        if !columns.contains(&Column::Time) {
            return Err(format!("its first line names no time: understood are {NAMES}"));
        }
        for (k, column) in columns.iter().enumerate() {
            if *column != Column::Other && columns[..k].contains(column) {
                return Err("two columns of its first line have the same meaning".into());
            }
        }
        let named = |wanted: bool| {
            columns.iter().filter_map(move |column| match column {
                Column::Of { velocity, particle, .. } if *velocity == wanted => Some(*particle),
                _ => None,
            })
        };
        let wide = named(false).any(|particle| particle.is_some());
        let first = named(false).flatten().min().unwrap_or(0);
        let layout = Self {
            wide,
            velocities: named(true).next().is_some(),
            numbered: columns.contains(&Column::Particle),
            first,
            particles,
        };
        if first > 1 {
            return Err(format!(
                "its particles begin with {first}: the first has the number 0 or 1"
            ));
        }
        for velocity in [false, true] {
            if velocity && !layout.velocities {
                continue;
            }
            let has = |axis, particle| columns.contains(&Column::Of { velocity, axis, particle });
            let what = if velocity { "velocities" } else { "positions" };
            if !wide {
                if !has(0, None) || !has(1, None) {
                    return Err(format!(
                        "its first line names no {what} x, y, z: understood are {NAMES}"
                    ));
                }
                continue;
            }
            let last = named(velocity).flatten().max();
            let count = last.map_or(0, |last| last.saturating_add(1) - first.min(last));
            if count != particles {
                return Err(format!(
                    "its first line names the {what} of {}, and the scene has {particles}",
                    counted(count, "particle")
                ));
            }
            for i in first..first + particles {
                if !has(0, Some(i)) || !has(1, Some(i)) || has(2, Some(i)) != has(2, Some(first)) {
                    return Err(format!("its first line lacks {what} of particle {i}"));
                }
            }
            if named(velocity).any(|particle| particle.is_none_or(|i| i < first)) {
                return Err(format!(
                    "its first line names {what} with and without numbers of particles"
                ));
            }
        }
        Ok(layout)
    }

    /// Returns the particle of a row, which is marked as seen.
    fn particle(&mut self, row: &CsvRow, raw: &States, seen: &mut [bool]) -> Result<usize, String> {
        let there = seen.iter().filter(|seen| **seen).count();
        let mut number = there;
        if self.numbered {
            let typed = row.number(Column::Particle)?;
            if typed < 0.0 || typed.fract() != 0.0 || !typed.is_finite() {
                return Err(format!("{typed} is no number of a particle"));
            }
            number = typed as usize;
            if there == 0 && raw.times.len() == 1 {
                self.first = number.min(1);
            }
        }
        let i = number.checked_sub(self.first);
        match i.and_then(|i| seen.get_mut(i)) {
            None => Err(format!(
                "there is no particle {number}: the scene has {}, and the first has the number {}",
                counted(self.particles, "particle"),
                self.first
            )),
            Some(true) => Err(format!("particle {number} is there twice at this time")),
            Some(seen) => {
                *seen = true;
                Ok(number - self.first)
            }
        }
    }

    /// Checks that all particles are there at the last time.
    fn check_group(&self, seen: &[bool], raw: &States) -> Result<(), String> {
        let there = seen.iter().filter(|seen| **seen).count();
        match raw.times.last() {
            Some(t) if there != self.particles => Err(format!(
                "t = {t} s has {}, and the scene has {}",
                counted(there, "particle"),
                self.particles
            )),
            _ => Ok(()),
        }
    }
}

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
        let bare = number.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
        let bare = bare.unwrap_or_else(|| number.trim_start_matches('_'));
        let particle = match bare.parse() {
            Ok(particle) => Some(particle),
            Err(_) if number.is_empty() => None,
            Err(_) => return Self::Other,
        };
        Self::Of { velocity, axis, particle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_many_programs_are_understood() {
        let of = |velocity, axis, particle| Column::Of { velocity, axis, particle };
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
