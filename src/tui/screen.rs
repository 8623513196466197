//! The screens by name and number.

/// A screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Screen {
    /// Edit the plan, run it, watch.
    Sweep,
    /// The scene, live.
    Preview,
    /// One ray, step by step.
    Inspect,
    /// Curves over n.
    Charts,
    /// Speed against wrong decisions.
    Pareto,
    /// Where each kernel and accelerator breaks.
    Stability,
    /// Bundles on disk.
    Reports,
    /// All keys.
    Help,
}

impl Screen {
    /// All screens; the key of a screen is its place here, from 1.
    pub const ALL: [Self; 8] = [
        Self::Sweep,
        Self::Preview,
        Self::Inspect,
        Self::Charts,
        Self::Pareto,
        Self::Stability,
        Self::Reports,
        Self::Help,
    ];

    /// Its name.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Sweep => "Sweep",
            Self::Preview => "Preview",
            Self::Inspect => "Inspect",
            Self::Charts => "Charts",
            Self::Pareto => "Pareto",
            Self::Stability => "Stability",
            Self::Reports => "Reports",
            Self::Help => "Help",
        }
    }

    /// Its key.
    #[must_use]
    pub fn number(self) -> usize {
        Self::ALL
            .iter()
            .position(|&s| s == self)
            .map_or(0, |at| at + 1)
    }

    /// The screen `steps` further round.
    #[must_use]
    pub fn turned(self, steps: isize) -> Self {
        let at = self.number() as isize - 1;
        Self::ALL[(at + steps).rem_euclid(Self::ALL.len() as isize) as usize]
    }
}
