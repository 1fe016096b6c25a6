//! CDR, as ROS 2 writes messages: numbers aligned to their own size, texts and lists after their length.
//!
//! # Source
//! OMG, "DDS Interoperability Wire Protocol" 2.5, 10.2 (encapsulation), and CORBA 3.0, 15.3 (Common Data Representation).

/// Bytes before the first value: the encoding and options.
const HEADER: usize = 4;
/// Longest list; a broken message could otherwise allocate all memory.
const MOST: usize = 1 << 20;

/// A message while it is read; every reader gives `None` where it ends too early.
pub(crate) struct Cdr<'a> {
    bytes: &'a [u8],
    at: usize,
    little: bool,
}

impl<'a> Cdr<'a> {
    /// Plain CDR of either byte order; `None` for any other encoding.
    pub fn new(message: &'a [u8]) -> Option<Self> {
        let little = match message.get(..2)? {
            [0, 0] => false,
            [0, 1] => true,
            _ => return None,
        };
        Some(Self { bytes: message.get(HEADER..)?, at: 0, little })
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let start = self.at.next_multiple_of(N);
        let mut bytes: [u8; N] = self.bytes.get(start..start + N)?.try_into().ok()?;
        self.at = start + N;
        if !self.little {
            bytes.reverse();
        }
        Some(bytes)
    }

    pub fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    pub fn i32(&mut self) -> Option<i32> {
        self.take().map(i32::from_le_bytes)
    }

    pub fn f64(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    pub fn numbers<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.f64()?;
        }
        Some(numbers)
    }

    /// A text, without the 0 that ends it.
    pub fn text(&mut self) -> Option<String> {
        let length = self.u32()? as usize;
        let bytes = self.bytes.get(self.at..self.at.checked_add(length)?)?;
        self.at += length;
        let text = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        String::from_utf8(text.to_vec()).ok()
    }

    /// A list, each entry read by `entry`.
    pub fn list<T>(&mut self, mut entry: impl FnMut(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let length = self.u32()? as usize;
        if length > MOST {
            return None;
        }
        (0..length).map(|_| entry(self)).collect()
    }
}
