//! A reader of binary values, which returns `None` at the end of the bytes.

use half::f16;

/// Bytes that are read from their start.
#[derive(Clone, Debug)]
pub struct Bytes<'a> {
    data: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl<'a> Bytes<'a> {
    /// A reader at the beginning of `data`.
    pub fn new(data: &'a [u8], big_endian: bool) -> Self {
        Self { data, at: 0, big_endian }
    }

    /// The number of remaining bytes.
    pub fn left(&self) -> usize {
        self.data.len() - self.at
    }

    /// The next `count` bytes.
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let taken = self.data.get(self.at..self.at.checked_add(count)?)?;
        self.at += count;
        Some(taken)
    }

    /// Advances to the next multiple of `size` from the beginning.
    pub fn align(&mut self, size: usize) -> Option<()> {
        let over = self.at % size;
        if over > 0 {
            self.take(size - over)?;
        }
        Some(())
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut bytes: [u8; N] = self.take(N)?.try_into().ok()?;
        if self.big_endian {
            bytes.reverse();
        }
        Some(bytes)
    }

    /// An unsigned integer of two bytes.
    pub fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    /// An unsigned integer of four bytes.
    pub fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    /// An unsigned integer of eight bytes.
    pub fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// A floating-point number of eight bytes.
    pub fn f64(&mut self) -> Option<f64> {
        self.array().map(f64::from_le_bytes)
    }

    /// A string with its length in the four bytes before it; a zero at its end is not part of it.
    pub fn text(&mut self) -> Option<&'a str> {
        let length = self.u32()?;
        let text = self.take(usize::try_from(length).ok()?)?;
        std::str::from_utf8(text.strip_suffix(b"\0").unwrap_or(text)).ok()
    }

    /// The remaining bytes, with the other byte order.
    pub fn rest(self, big_endian: bool) -> Self {
        Self::new(&self.data[self.at..], big_endian)
    }

    /// `count` integers of `size` bytes; `None` if the bytes end before. Unsigned integers beyond the range of signed
    /// ones are limited to that range.
    pub fn integers(mut self, size: usize, signed: bool, count: usize) -> Option<Vec<i64>> {
        if count > self.left() / size {
            return None;
        }
        let mut values = Vec::with_capacity(count);
        for _ in 0..count {
            let bytes = self.take(size)?;
            let mut wide = [0; 8];
            for (index, byte) in bytes.iter().enumerate() {
                wide[if self.big_endian { size - 1 - index } else { index }] = *byte;
            }
            let unused = 64 - 8 * size as u32;
            let value = u64::from_le_bytes(wide);
            values.push(if signed {
                (value << unused).cast_signed() >> unused
            } else {
                i64::try_from(value).unwrap_or(i64::MAX)
            });
        }
        Some(values)
    }

    /// `count` floating-point numbers of four or eight bytes; `None` if the bytes end before.
    pub fn numbers(mut self, size: usize, count: usize) -> Option<Vec<f64>> {
        if count > self.left() / size {
            return None;
        }
        let mut values = Vec::with_capacity(count);
        for _ in 0..count {
            let single = |bytes: &mut Self| bytes.u32().map(|bits| f64::from(f32::from_bits(bits)));
            values.push(match size {
                2 => f16::from_bits(self.u16()?).to_f64(),
                4 => single(&mut self)?,
                _ => self.f64()?,
            });
        }
        Some(values)
    }
}
