//! Images: which colour a hit has, and no more model than the scene needs.
