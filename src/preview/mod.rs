//! Images as terminal cells: symbols and colours.
