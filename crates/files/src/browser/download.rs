//! Downloads.

use js_sys::{Array, Uint8Array};
use wasm_bindgen::JsCast;
use wasm_bindgen::prelude::*;
use web_sys::{Blob, HtmlAnchorElement, Url};

use super::window::{canvas, document};

/// Offers bytes as a download with this name.
pub fn download(name: &str, bytes: &[u8]) -> Result<(), &'static str> {
    let parts = Array::of1(&Uint8Array::from(bytes));
    let blob = Blob::new_with_u8_array_sequence(&parts);
    blob.map_err(|_| "the browser has no memory for the file")
        .and_then(|blob| offer(name, &blob))
}

/// Offers the present picture of the canvas as a download with this name.
pub fn download_picture(name: String) {
    let offer = Closure::once_into_js(move |blob: Option<Blob>| {
        if let Some(blob) = blob {
            let _ = offer(&name, &blob);
        }
    });
    if let Some(canvas) = canvas() {
        let _ = canvas.to_blob(offer.unchecked_ref());
    }
}

fn offer(name: &str, blob: &Blob) -> Result<(), &'static str> {
    let refused = "the browser refused the download";
    let url = Url::create_object_url_with_blob(blob).map_err(|_| refused)?;
    let link = document().and_then(|document| document.create_element("a").ok());
    let link = link.and_then(|link| link.dyn_into::<HtmlAnchorElement>().ok());
    let link = link.ok_or(refused)?;
    link.set_href(&url);
    link.set_download(name);
    link.click();
    let _ = Url::revoke_object_url(&url);
    Ok(())
}
