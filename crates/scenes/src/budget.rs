//! Budget of a scene: what its text and its parts may take, counted before anything is reserved.
//! Whatever a file says, it is accepted or refused within seconds and 256 MiB.

use a3_core::Grid;

use crate::fault::Fault;

/// Memory of the parts of a scene (bytes).
const LARGEST: usize = 192 << 20;

/// Memory that a reader takes at most for a sign of a text (bytes).
const SIGN: usize = 250;
/// Largest number of signs in a text.
const MOST_SIGNS: usize = 800_000;

/// Kind of part of a scene, and the memory that one takes at most (bytes), as it was measured.
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
/// Particles that are looked at to find those of a place such as `top`.
pub(crate) const LOOKED_AT: Part = Part("particles to look at for pins", 1);
pub(crate) const TRIANGLES: Part = Part("triangles in files", 60);
pub(crate) const CELLS: Part = Part("tetrahedra in files", 200);
/// Triangles of obstacles.
pub(crate) const FACES: Part = Part("triangles of obstacles", 600);

/// Memory that is left for the parts of a scene.
pub(crate) struct Budget {
    left: usize,
    whole: usize,
}

impl Budget {
    /// The budget of a scene, and of that grid besides, which the command line asks for.
    pub fn new(grid: Option<Grid>) -> Self {
        let each = [PARTICLES, TOUCHING, STRIPS, STRIPS, PINS].map(|Part(_, price)| price);
        let asked = grid.map_or(0, |grid| grid.particles() * each.iter().sum::<usize>());
        let whole = LARGEST + asked;
        Self { left: whole, whole }
    }

    /// Takes so many parts from what is left, or is a fault of that key.
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
            let why = format!("not enough memory for {count} {name}, which take {takes} MiB");
            return Err(Fault::new(key, why));
        }
        self.left = left;
        Ok(())
    }
}

/// Whether the system has so much memory (bytes) for this process.
fn is_free(bytes: usize) -> bool {
    std::hint::black_box(&mut Vec::<u8>::new())
        .try_reserve_exact(bytes)
        .is_ok()
}

/// `Ok` if a text has no more signs than a reader takes little memory for: commas, brackets, ends
/// of lines and the like, and gaps between words. Points that belong to no number count eightfold,
/// because each begins a table.
pub(crate) fn check_text(text: &[u8]) -> Result<(), String> {
    let is_word = |b: u8| b.is_ascii_alphanumeric() || !b.is_ascii() || b"_+-".contains(&b);
    let is_digit = |b: Option<&u8>| b.is_some_and(u8::is_ascii_digit);
    let (mut signs, mut last, mut in_number) = (0, b'\n', false);
    for (k, &b) in text.iter().enumerate() {
        let is_next = k > 0 && text[k - 1] == last;
        match b {
            b' ' | b'\t' | b'\r' => continue,
            b'.' if is_next && is_digit(Some(&last)) && is_digit(text.get(k + 1)) && !in_number => {
                in_number = true;
            }
            b'.' => signs += 8,
            _ if !is_word(b) => (signs, in_number) = (signs + 1, false),
            _ if !is_next && is_word(last) => (signs, in_number) = (signs + 1, false),
            _ => {}
        }
        last = b;
    }
    if signs > MOST_SIGNS {
        return Err(format!(
            "it is too long: it has more than {MOST_SIGNS} commas, brackets, ends of lines and \
             other signs"
        ));
    }
    if !is_free(signs * SIGN) {
        return Err(format!("not enough memory to read {} bytes", text.len()));
    }
    Ok(())
}
