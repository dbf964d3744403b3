//! Memory budget of a scene: what its text and its parts may take, counted before memory is
//! reserved. Any file is accepted or refused within seconds and 256 MiB.

use a3_core::Grid;

use crate::fault::Fault;

/// Largest memory of the parts of a scene (bytes).
const MAX_MEMORY: usize = 192 << 20;

/// Largest memory that a reader takes for a token of a text (bytes).
const TOKEN_MEMORY: usize = 250;
/// Largest number of tokens in a text.
const MAX_TOKENS: usize = 800_000;

/// Kind of part of a scene: its name, and the measured memory that one takes at most (bytes).
#[derive(Clone, Copy)]
pub(crate) struct Part(&'static str, usize);

pub(crate) const BODIES: Part = Part("bodies", 50_000);
pub(crate) const PARTICLES: Part = Part("particles", 360);
/// Particles whose surfaces touch.
pub(crate) const TOUCHING: Part = Part("particles that touch", 2200);
pub(crate) const SPRINGS: Part = Part("springs", 160);
/// Parts of rigid bodies.
pub(crate) const PARTS: Part = Part("parts of rigid bodies", 20_000);
/// Springs that buckle.
pub(crate) const STRIPS: Part = Part("springs that buckle", 200);
/// Particles of fluid, with the lists of their neighbours.
pub(crate) const SMOOTHED: Part = Part("particles of fluid", 700);
pub(crate) const RODS: Part = Part("rods", 1000);
/// Tetrahedra of solids.
pub(crate) const TETRAHEDRA: Part = Part("tetrahedra", 700);
pub(crate) const PINS: Part = Part("pins", 700);
/// Particles that are searched for those of a spot such as `top`.
pub(crate) const SEARCHED: Part = Part("particles to look at for pins", 1);
pub(crate) const TRIANGLES: Part = Part("triangles in files", 60);
pub(crate) const CELLS: Part = Part("tetrahedra in files", 200);
/// Triangles of obstacles.
pub(crate) const FACES: Part = Part("triangles of obstacles", 600);

/// Memory that is left for the parts of a scene (bytes), of the whole.
pub(crate) struct Budget {
    left: usize,
    whole: usize,
}

impl Budget {
    /// Creates the budget of a scene. It grows by what a grid takes that the command line asks for.
    pub fn new(grid: Option<Grid>) -> Self {
        let each = [PARTICLES, TOUCHING, STRIPS, STRIPS, PINS].map(|Part(_, price)| price);
        let asked = grid.map_or(0, |grid| grid.particles() * each.iter().sum::<usize>());
        let whole = MAX_MEMORY + asked;
        Self { left: whole, whole }
    }

    /// Takes `count` parts from the budget. If it does not suffice, that is a fault of the key.
    pub fn spend(&mut self, key: &str, count: usize, part: Part) -> Result<(), Fault> {
        let Part(name, price) = part;
        let bytes = count.saturating_mul(price);
        let Some(left) = self.left.checked_sub(bytes) else {
            let [takes, left, whole] = [bytes, self.left, self.whole].map(|bytes| bytes >> 20);
            let why = format!(
                "the scene would have {count} {name}, which take {takes} MiB; of the {whole} MiB \
                 that a scene may take {left} are left"
            );
            return Err(Fault::new(key, why));
        };
        if !is_free(bytes) {
            let takes = bytes >> 20;
            refuse!(key: "not enough memory for {count} {name}, which take {takes} MiB");
        }
        self.left = left;
        Ok(())
    }
}

/// Returns whether the system can give the process this much memory (bytes).
fn is_free(bytes: usize) -> bool {
    std::hint::black_box(&mut Vec::<u8>::new()).try_reserve_exact(bytes).is_ok()
}

/// Checks that a text has few enough tokens (commas, brackets, ends of lines, gaps between words)
/// to be read in little memory. A point outside a number counts eightfold, because it begins a
/// table.
pub(crate) fn check_text(text: &[u8]) -> Result<(), String> {
    let is_word = |b: u8| b.is_ascii_alphanumeric() || !b.is_ascii() || b"_+-".contains(&b);
    let is_digit = |b: Option<&u8>| b.is_some_and(u8::is_ascii_digit);
    let (mut tokens, mut last, mut in_number) = (0, b'\n', false);
    for (k, &b) in text.iter().enumerate() {
        let is_next = k > 0 && text[k - 1] == last;
        match b {
            b' ' | b'\t' | b'\r' => continue,
            b'.' if is_next && is_digit(Some(&last)) && is_digit(text.get(k + 1)) && !in_number => {
                in_number = true;
            }
            b'.' => tokens += 8,
            _ if !is_word(b) => (tokens, in_number) = (tokens + 1, false),
            _ if !is_next && is_word(last) => (tokens, in_number) = (tokens + 1, false),
            _ => {}
        }
        last = b;
    }
    if tokens > MAX_TOKENS {
        return Err(format!(
            "it is too long: it has more than {MAX_TOKENS} commas, brackets, ends of lines and \
             other signs"
        ));
    }
    refuse!(if !is_free(tokens * TOKEN_MEMORY) => "not enough memory to read {} bytes", text.len());
    Ok(())
}
