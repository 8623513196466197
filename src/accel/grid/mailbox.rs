//! Mailboxes: a triangle that lies in several cells of a ray is tested once.
//!
//! **Source:** M. Shevtsov, A. Soupikov and A. Kapustin, "Ray-Triangle Intersection Algorithm for Modern CPU
//! Architectures", Graphicon 2007 (inverse mailboxing: a small table of what the *ray* has tested, where Amanatides and
//! Woo 1987 keep the last ray in every *triangle*).
//! **Differs:** the table is direct-mapped by a hash and its entries carry the ray's number, so that a new ray costs one
//! increment and a new batch of rays 8 KiB of zeros, whatever the mesh. A number in every triangle would cost a fresh
//! array of all triangles for each batch. A triangle whose entry another has taken is tested again: rare, and harmless.

/// Remembers what a ray has tested.
pub(super) trait Mailbox: Default + Send + Sync + 'static {
    /// The next ray begins.
    fn begin(&mut self);

    /// Whether this ray must test `prim`; takes it for tested from now on.
    fn takes(&mut self, prim: u32) -> bool;
}

/// `mailbox=off`: every reference is tested.
#[derive(Debug, Default)]
pub struct Forgetful;

impl Mailbox for Forgetful {
    #[inline(always)]
    fn begin(&mut self) {}

    #[inline(always)]
    fn takes(&mut self, _: u32) -> bool {
        true
    }
}

/// Entries of the table: rays rarely test a hundred triangles, and 8 KiB leave room in a first-level cache.
const ENTRIES_LOG2: u32 = 10;

/// `mailbox=on`: the ray's recent tests, by hash.
#[derive(Debug)]
pub struct Hashed {
    /// The number of the ray, never 0, above the triangle that it tested; 0 in entries never used.
    entries: Box<[u64; 1 << ENTRIES_LOG2]>,
    ray: u64,
}

impl Default for Hashed {
    fn default() -> Self {
        Self {
            entries: Box::new([0; 1 << ENTRIES_LOG2]),
            ray: 0,
        }
    }
}

impl Mailbox for Hashed {
    #[inline(always)]
    fn begin(&mut self) {
        self.ray = self.ray.wrapping_add(1 << u32::BITS);
        if self.ray == 0 {
            // 2³² rays later numbers would return.
            *self = Self::default();
            self.ray = 1 << u32::BITS;
        }
    }

    #[inline(always)]
    fn takes(&mut self, prim: u32) -> bool {
        // Fibonacci hashing (Knuth, volume 3, section 6.4): runs of neighbours and rows of a regular mesh both spread.
        let place = prim.wrapping_mul(0x9E37_79B1) >> (u32::BITS - ENTRIES_LOG2);
        let mail = self.ray | u64::from(prim);
        std::mem::replace(&mut self.entries[place as usize], mail) != mail
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_takes_a_triangle_once_and_the_next_ray_takes_it_again() {
        let mut mailbox = Hashed::default();
        for _ in 0..3 {
            mailbox.begin();
            assert!((0..200).all(|prim| mailbox.takes(prim)));
            assert!(
                (0..200).all(|prim| !mailbox.takes(prim)),
                "neighbours share no entry"
            );
        }
    }

    #[test]
    fn rows_of_a_regular_mesh_do_not_share_entries() {
        let mut mailbox = Hashed::default();
        mailbox.begin();
        let rows = || (0..32_u32).map(|row| row * 1024);
        assert!(rows().all(|prim| mailbox.takes(prim)));
        assert!(rows().all(|prim| !mailbox.takes(prim)));
    }

    #[test]
    fn triangle_0_of_the_first_ray_is_fresh_and_numbers_wrap_without_stale_mail() {
        let mut mailbox = Hashed::default();
        mailbox.begin();
        assert!(mailbox.takes(0));
        mailbox.ray = u64::from(u32::MAX) << u32::BITS;
        mailbox.begin();
        assert!(mailbox.takes(0), "the table was cleared");
        assert!(!mailbox.takes(0));
    }
}
