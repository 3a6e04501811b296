//! Numbers as text: little-endian bytes in base64 (RFC 4648, section 4).

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Bytes in base64, padded.
pub(super) fn encode(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(length(bytes.len()));
    for three in bytes.chunks(3) {
        let byte = |i: usize| u32::from(three.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            let pad = digit > three.len();
            let place = bits >> (18 - 6 * digit) & 63;
            text.push(if pad {
                '='
            } else {
                char::from(DIGITS[place as usize])
            });
        }
    }
    text
}

/// Length of so many bytes in base64.
pub(super) fn length(bytes: usize) -> usize {
    bytes.div_ceil(3) * 4
}

/// Small floats.
pub(super) fn floats(values: impl IntoIterator<Item = f64>) -> String {
    let bytes: Vec<u8> = values
        .into_iter()
        .flat_map(|v| (v as f32).to_le_bytes())
        .collect();
    encode(&bytes)
}

/// Whole numbers of 16 bits.
pub(super) fn words(values: impl IntoIterator<Item = u16>) -> String {
    let bytes: Vec<u8> = values.into_iter().flat_map(u16::to_le_bytes).collect();
    encode(&bytes)
}

/// Whole numbers of 32 bits.
pub(super) fn longs(values: impl IntoIterator<Item = u32>) -> String {
    let bytes: Vec<u8> = values.into_iter().flat_map(u32::to_le_bytes).collect();
    encode(&bytes)
}

#[cfg(test)]
pub(super) fn decode(text: &str) -> Vec<u8> {
    let digits: Vec<u32> = text
        .bytes()
        .filter(|b| *b != b'=')
        .map(|b| DIGITS.iter().position(|d| *d == b).unwrap() as u32)
        .collect();
    digits
        .chunks(4)
        .flat_map(|four| {
            let bits = four
                .iter()
                .enumerate()
                .fold(0, |bits, (i, d)| bits | d << (18 - 6 * i));
            bits.to_be_bytes()[1..four.len()].to_vec()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_examples_of_the_standard_and_every_byte_come_back() {
        // RFC 4648, section 10
        for (plain, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(encode(plain.as_bytes()), coded);
            assert_eq!(length(plain.len()), coded.len());
            assert_eq!(decode(coded), plain.as_bytes());
        }
        let bytes: Vec<u8> = (0..=255).collect();
        assert_eq!(decode(&encode(&bytes)), bytes);
        assert_eq!(decode(&words([1, 0x0203])), [1, 0, 3, 2]);
        assert_eq!(decode(&longs([1])), [1, 0, 0, 0]);
        assert_eq!(decode(&floats([1.5])), 1.5_f32.to_le_bytes());
    }
}
