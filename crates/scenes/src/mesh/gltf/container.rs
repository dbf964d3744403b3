//! Containers of glTF: binary files, data URIs, and percent-encoded names.

use std::borrow::Cow;

use base64::Engine;

use crate::text::unmarked;

/// Finds the JSON text of a file, and its binary part if it has one.
pub(super) fn parts(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    if !bytes.starts_with(b"glTF") {
        return Ok((unmarked(bytes)?, None));
    }
    let word = |at: usize| {
        let word = bytes.get(at..at + 4)?.try_into().ok()?;
        Some(u32::from_le_bytes(word) as usize)
    };
    let kind = |at: usize| bytes.get(at + 4..at + 8);
    let data = |at: usize| bytes.get(at + 8..)?.get(..word(at)?);
    match word(4) {
        Some(2) => {}
        Some(1) => return Err("it is glTF 1.0: convert it to glTF 2.0".into()),
        _ => return Err("it is no glTF 2.0 file: its version is not 2".into()),
    }
    let json = data(12).filter(|_| kind(12) == Some(b"JSON"));
    let json = json.ok_or("it is no glTF 2.0 file: its JSON part is cut short")?;
    // Parts should begin at multiples of four, but some programs do not pad them.
    let end = 20 + json.len();
    let next = [end, end.next_multiple_of(4)];
    let next = next.into_iter().find(|at| kind(*at) == Some(b"BIN\0"));
    let cut = || "its binary part is cut short".to_owned();
    let binary = match next {
        Some(at) => Some(data(at).ok_or_else(cut)?),
        None if end.next_multiple_of(4) >= bytes.len() => None,
        None => return Err(cut()),
    };
    let json = json.trim_ascii_end();
    let padding = json.iter().rev().take_while(|b| **b == 0).count();
    Ok((&json[..json.len() - padding], binary))
}

/// Decodes the bytes of a data URI.
pub(super) fn decoded(data: &str) -> Result<Vec<u8>, String> {
    let (_, text) = data.split_once("base64,").ok_or("its data is not base64")?;
    let decoded = base64::engine::general_purpose::STANDARD.decode(text);
    decoded.map_err(|_| "its data is not base64".into())
}

/// Decodes a percent-encoded name, in which `%20` stands for a space.
pub(super) fn unescaped(uri: &str) -> Cow<'_, str> {
    if !uri.contains('%') {
        return uri.into();
    }
    let mut bytes = vec![];
    let mut rest = uri.as_bytes();
    while let Some((first, after)) = rest.split_first() {
        let code = after.get(..2).filter(|_| *first == b'%');
        let code = code.and_then(|code| u8::from_str_radix(str::from_utf8(code).ok()?, 16).ok());
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &after[2..] } else { after };
    }
    String::from_utf8(bytes).map_or(uri.into(), Cow::from)
}
