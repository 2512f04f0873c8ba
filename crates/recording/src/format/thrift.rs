//! Whether the lists of a message in Thrift's compact protocol fit into its bytes.
//!
//! The Parquet library skips as many items as a damaged footer says, up to 2³¹ in each list, also where the bytes have ended.

/// The deepest nesting; Parquet's footers have less than ten levels.
const DEEPEST: usize = 64;

/// Whether a list of the structure in `bytes` has more items than bytes follow. Every item takes at least one byte. Other
/// damage is left to the library.
pub fn has_endless_list(bytes: &[u8]) -> bool {
    let mut walk = Walk { rest: bytes, is_endless: false };
    walk.structure(0);
    walk.is_endless
}

struct Walk<'a> {
    rest: &'a [u8],
    is_endless: bool,
}

impl Walk<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (&byte, rest) = self.rest.split_first()?;
        self.rest = rest;
        Some(byte)
    }

    fn skip(&mut self, count: usize) -> Option<()> {
        self.rest = self.rest.get(count..)?;
        Some(())
    }

    fn number(&mut self) -> Option<u64> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(number);
            }
        }
        None
    }

    /// `count` items of one kind, or pairs of two.
    fn items(&mut self, count: u64, kinds: &[u8], depth: usize) -> Option<()> {
        if count > self.rest.len() as u64 {
            self.is_endless = true;
            return None;
        }
        for _ in 0..count {
            for &kind in kinds {
                // Unlike a field, an item that is a truth value has a byte.
                if matches!(kind, 1 | 2) {
                    self.skip(1)?;
                } else {
                    self.value(kind, depth)?;
                }
            }
        }
        Some(())
    }

    fn value(&mut self, kind: u8, depth: usize) -> Option<()> {
        match kind {
            1 | 2 => Some(()),
            3 => self.skip(1),
            4..=6 => self.number().map(|_| ()),
            7 => self.skip(8),
            8 => {
                let length = self.number()?;
                self.skip(usize::try_from(length).ok()?)
            }
            9 | 10 => {
                let head = self.byte()?;
                let count = if head >> 4 == 15 { self.number()? } else { u64::from(head >> 4) };
                self.items(count, &[head & 15], depth + 1)
            }
            11 => {
                let count = self.number()?;
                let kinds = if count > 0 { self.byte()? } else { 0 };
                self.items(count, &[kinds >> 4, kinds & 15], depth + 1)
            }
            12 => self.structure(depth + 1),
            13 => self.skip(16),
            _ => None,
        }
    }

    fn structure(&mut self, depth: usize) -> Option<()> {
        if depth > DEEPEST {
            return None;
        }
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Some(());
            }
            if head >> 4 == 0 {
                self.number()?;
            }
            self.value(head & 15, depth)?;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_lists_beyond_the_bytes_are_endless() {
        // Field 1, a list of three truth values; field 2, a structure with a number; the end.
        let whole = [0x19, 0x31, 1, 2, 1, 0x1c, 0x15, 4, 0, 0];
        assert!(!has_endless_list(&whole));
        // The list has 2³¹ − 1 items.
        let endless = [0x19, 0xf1, 0xff, 0xff, 0xff, 0xff, 7, 1, 0];
        assert!(has_endless_list(&endless));
        assert!(has_endless_list(&whole[..4]), "it is cut within a list");
        assert!(!has_endless_list(&[0x1c; 1000]), "it is nested too deeply");
    }
}
