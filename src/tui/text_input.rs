//! One line of text with a cursor.

/// A text being edited. The cursor stands between characters, counted from 0.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TextInput {
    text: String,
    cursor: usize,
}

impl TextInput {
    /// `text` with the cursor at its end.
    #[must_use]
    pub fn new(text: impl Into<String>) -> Self {
        let text = text.into();
        Self {
            cursor: text.chars().count(),
            text,
        }
    }

    /// The text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Characters before the cursor.
    #[must_use]
    pub fn cursor(&self) -> usize {
        self.cursor
    }

    /// Puts a character before the cursor; control characters are left out.
    pub fn insert(&mut self, c: char) {
        if !c.is_control() {
            self.text.insert(self.byte(self.cursor), c);
            self.cursor += 1;
        }
    }

    /// Removes the character before the cursor, if there is one.
    pub fn erase(&mut self) {
        if self.cursor > 0 {
            self.cursor -= 1;
            self.text.remove(self.byte(self.cursor));
        }
    }

    /// Removes the whole text.
    pub fn clear(&mut self) {
        self.text.clear();
        self.cursor = 0;
    }

    /// Moves the cursor by one character.
    pub fn left(&mut self) {
        self.cursor = self.cursor.saturating_sub(1);
    }

    /// Moves the cursor by one character.
    pub fn right(&mut self) {
        self.cursor = (self.cursor + 1).min(self.text.chars().count());
    }

    /// Moves the cursor before the first character.
    pub fn home(&mut self) {
        self.cursor = 0;
    }

    /// Moves the cursor behind the last character.
    pub fn end(&mut self) {
        self.cursor = self.text.chars().count();
    }

    /// The part that fits into `width` columns with the cursor in it, and the cursor's column there.
    #[must_use]
    pub fn window(&self, width: usize) -> (String, usize) {
        let start = (self.cursor + 1).saturating_sub(width);
        let shown = self.text.chars().skip(start).take(width).collect();
        (shown, self.cursor - start)
    }

    fn byte(&self, position: usize) -> usize {
        self.text
            .char_indices()
            .nth(position)
            .map_or(self.text.len(), |(byte, _)| byte)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_go_in_and_out_at_the_cursor_whatever_their_bytes() {
        let mut input = TextInput::new("nö");
        input.insert('→');
        input.left();
        input.left();
        input.insert('x');
        assert_eq!(input.text(), "nxö→");
        input.erase();
        input.erase();
        input.erase();
        assert_eq!((input.text(), input.cursor()), ("ö→", 0));
        input.end();
        input.erase();
        assert_eq!(input.text(), "ö");
        input.insert('\u{1b}');
        assert_eq!(input.text(), "ö");
        input.clear();
        assert_eq!((input.text(), input.cursor()), ("", 0));
    }

    #[test]
    fn the_window_always_holds_the_cursor() {
        let mut input = TextInput::new("abcdefgh");
        assert_eq!(input.window(4), ("fgh".to_owned(), 3));
        input.home();
        assert_eq!(input.window(4), ("abcd".to_owned(), 0));
        input.right();
        assert_eq!(input.window(4), ("abcd".to_owned(), 1));
    }
}
