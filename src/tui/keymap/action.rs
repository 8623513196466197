//! What keys can do.

/// What a key does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Action {
    /// Leave the program.
    Quit,
    /// Show the keys.
    Help,
    /// Go to the next screen.
    NextScreen,
    /// Go to the previous screen.
    PreviousScreen,
    /// Go to the screen of that number, from 1.
    Screen(u8),
    /// Hand the terminal back to the shell until resumed.
    Suspend,
    /// Draw the whole screen again.
    Repaint,
    /// Leave what lies on top, or go back.
    Back,
    /// One up.
    Up,
    /// One down.
    Down,
    /// One to the left.
    Left,
    /// One to the right.
    Right,
    /// To the first.
    First,
    /// To the last.
    Last,
    /// A page up, or nearer.
    PageUp,
    /// A page down, or farther.
    PageDown,
    /// Run the plan.
    Run,
    /// Open what is marked.
    Open,
    /// Change the marked line of the plan.
    Edit,
    /// Change the marked line of the plan as text.
    Type,
    /// Take or leave the marked choice.
    Toggle,
    /// Take all choices, or none.
    ToggleAll,
    /// More samples a run.
    MoreSamples,
    /// Fewer samples a run.
    FewerSamples,
    /// Wait, or go on.
    Pause,
    /// End the sweep.
    Stop,
    /// Write the report now.
    Write,
    /// Sort by the next column.
    Sort,
    /// Show only what contains a text.
    Filter,
    /// Give the focused panel the whole screen.
    Expand,
    /// Hold the display still.
    Freeze,
    /// Put a cursor into the picture.
    Aim,
    /// Another plane for the slice.
    Plane,
    /// Inspect a ray that goes wrong.
    Inspect,
    /// The other view of the same.
    Turn,
    /// The next cell that is not ok.
    NextFault,
    /// The previous cell that is not ok.
    PreviousFault,
    /// Write what is marked to files.
    Export,
    /// Closer to the marked step.
    ZoomIn,
    /// More of the way.
    ZoomOut,
    /// The next channel of the picture.
    Channel,
    /// The next kind of symbols.
    Symbols,
    /// The next accelerator.
    NextAccel,
    /// The previous accelerator.
    PreviousAccel,
    /// A finer grid.
    Finer,
    /// A coarser grid.
    Coarser,
    /// The next kernel.
    NextKernel,
    /// The next scene.
    NextScene,
    /// The previous scene.
    PreviousScene,
    /// Accept what was typed, or answer yes.
    Accept,
    /// Erase the character before the cursor.
    Erase,
    /// Erase the whole text.
    Clear,
    /// Answer no.
    Refuse,
}
