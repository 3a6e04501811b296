//! Numbers as text: little-endian bytes in base64 (RFC 4648, section 4).

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

/// Bytes in base64 with padding.
pub(super) fn encode(bytes: &[u8]) -> String {
    STANDARD.encode(bytes)
}

/// Length of this number of bytes in base64.
pub(super) fn length(bytes: usize) -> usize {
    bytes.div_ceil(3) * 4
}

/// Single-precision numbers.
pub(super) fn floats(values: impl IntoIterator<Item = f64>) -> String {
    let bytes: Vec<u8> = values
        .into_iter()
        .flat_map(|v| (v as f32).to_le_bytes())
        .collect();
    encode(&bytes)
}

/// Integers of 16 bits.
pub(super) fn words(values: impl IntoIterator<Item = u16>) -> String {
    let bytes: Vec<u8> = values.into_iter().flat_map(u16::to_le_bytes).collect();
    encode(&bytes)
}

/// Integers of 32 bits.
pub(super) fn longs(values: impl IntoIterator<Item = u32>) -> String {
    let bytes: Vec<u8> = values.into_iter().flat_map(u32::to_le_bytes).collect();
    encode(&bytes)
}

#[cfg(test)]
pub(super) fn decode(text: &str) -> Vec<u8> {
    STANDARD.decode(text).unwrap()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_little_endian_and_as_long_as_said() {
        let bytes: Vec<u8> = (0..=255).collect();
        for n in 0..5 {
            assert_eq!(length(n), encode(&bytes[..n]).len());
        }
        assert_eq!(decode(&words([1, 0x0203])), [1, 0, 3, 2]);
        assert_eq!(decode(&longs([1])), [1, 0, 0, 0]);
        assert_eq!(decode(&floats([1.5])), 1.5_f32.to_le_bytes());
    }
}
