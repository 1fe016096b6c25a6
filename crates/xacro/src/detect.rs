//! Xacro or plain URDF?

/// Whether an XML text is xacro: it declares the namespace prefix `xacro`, or has an element with it.
///
/// Comments and CDATA sections do not count. The text need not be well-formed.
pub fn is_xacro(text: &str) -> bool {
    let mut rest = text;
    while let Some(at) = rest.find('<') {
        rest = &rest[at..];
        let skipped =
            [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")].into_iter().find(|(open, _)| rest.starts_with(open));
        if let Some((open, close)) = skipped {
            match rest[open.len()..].find(close) {
                Some(end) => rest = &rest[open.len() + end + close.len()..],
                None => return false,
            }
            continue;
        }
        let end = rest.find('>').map_or(rest.len(), |end| end + 1);
        let tag = &rest[..end];
        if tag.starts_with("<xacro:") || tag.contains("xmlns:xacro") {
            return true;
        }
        rest = &rest[end..];
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_living_xacro_counts() {
        assert!(is_xacro(r#"<?xml version="1.0"?><robot xmlns:xacro="http://wiki.ros.org/xacro"/>"#));
        assert!(is_xacro("<robot><xacro:include filename='a'/>"));
        assert!(!is_xacro("<robot name='a'><!-- <xacro:if value='1'/> --></robot>"));
        assert!(!is_xacro("not XML at all"));
        assert!(!is_xacro("<!-- xmlns:xacro"));
    }
}
