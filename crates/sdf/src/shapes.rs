//! Visuals and collisions as URDF.

use crate::error::SdfProblemKind as Kind;
use crate::joints::within;
use crate::model::{Link, Model, Part, Reader};
use crate::pose::{number, several, text_of};
use denavit_model::write::escaped;
use roxmltree::Node;

/// A visual or collision as URDF; `None` where URDF does not have its shape.
pub(crate) fn shape<'a>(reader: &mut Reader<'a>, model: &Model<'a>, link: &Link<'a>, part: Part<'a>) -> Option<String> {
    let tag = part.node.tag_name().name();
    let geometry = part.child("geometry");
    let shape = geometry.and_then(|geometry| geometry.node.children().find(roxmltree::Node::is_element));
    let Some(shape) = shape.map(|node| Part { node, file: part.file }) else {
        reader.problem(part, Kind::MissingElement("geometry"));
        return None;
    };
    let name = shape.node.tag_name().name();
    let own = shape.node.tag_name().namespace().is_none();
    let written = match name {
        "box" if own => format!("<box size=\"{}\"/>", three(reader, shape, "size")?),
        "sphere" if own => format!("<sphere radius=\"{}\"/>", one(reader, shape, "radius")?),
        "cylinder" | "capsule" if own => {
            let (radius, length) = (one(reader, shape, "radius")?, one(reader, shape, "length")?);
            format!("<{name} radius=\"{radius}\" length=\"{length}\"/>")
        }
        "mesh" if own => {
            let Some(uri) = shape.child("uri").map(|uri| text_of(uri.node)) else {
                reader.problem(shape, Kind::MissingElement("uri"));
                return None;
            };
            let scale = match shape.child("scale") {
                Some(_) => format!(" scale=\"{}\"", three(reader, shape, "scale")?),
                None => String::new(),
            };
            if let Some(submesh) = shape.child("submesh") {
                reader.note(submesh, "<submesh> chooses a part of the mesh; the whole mesh is read here");
            }
            format!("<mesh filename=\"{}\"{scale}/>", escaped(uri))
        }
        _ => {
            if name != "empty" {
                reader.note(
                    shape,
                    format!("the shape <{name}> of a {tag} has no equivalent here; it is kept but not drawn"),
                );
            }
            return None;
        }
    };
    let step = within(reader, model, link.frame, link.scope, part)?;
    let origin = if step.is_identity() { String::new() } else { format!("<origin {}/>", step.origin) };
    let label = part.node.attribute("name").map_or_else(String::new, |name| format!(" name=\"{}\"", escaped(name)));
    let further = match tag {
        "visual" => part.child("material").map(|material| coloured(reader, material)),
        _ => part.child("surface").map(|surface| flat(reader, surface)),
    };
    Some(format!("<{tag}{label}>{origin}<geometry>{written}</geometry>{}</{tag}>", further.unwrap_or_default()))
}

fn one<'a>(reader: &mut Reader<'a>, shape: Part<'a>, tag: &'static str) -> Option<String> {
    let Some(part) = shape.child(tag) else {
        reader.problem(shape, Kind::MissingElement(tag));
        return None;
    };
    let checked = number(part.node);
    reader.take(part, checked)?;
    Some(text_of(part.node).to_owned())
}

fn three<'a>(reader: &mut Reader<'a>, shape: Part<'a>, tag: &'static str) -> Option<String> {
    let Some(part) = shape.child(tag) else {
        reader.problem(shape, Kind::MissingElement(tag));
        return None;
    };
    let checked = several(part.node, 3);
    Some(reader.take(part, checked)?.1.join(" "))
}

/// An element on one line: what is in it counts no line breaks.
fn flat(reader: &Reader, part: Part) -> String {
    let text = &reader.sources.files[part.file].text[part.node.range()];
    text.split(['\n', '\r']).map(str::trim).collect::<Vec<_>>().join(" ")
}

/// A material: its diffuse colour as URDF, and everything that it states.
fn coloured<'a>(reader: &Reader<'a>, material: Part<'a>) -> String {
    let diffuse = material.child("diffuse").map(|part| {
        let mut colour: Vec<&str> = text_of(part.node).split_whitespace().collect();
        if colour.len() == 3 {
            colour.push("1");
        }
        format!("<color rgba=\"{}\"/>", escaped(&colour.join(" ")))
    });
    // A colour and nothing else.
    let same = |tag: &'static str| material.child(tag).map(|part| text_of(part.node).to_owned());
    let plain = material.node.children().filter(Node::is_element).count() == 2 && same("ambient") == same("diffuse");
    if let (Some(colour), true) = (&diffuse, plain) {
        return format!("<material>{colour}</material>");
    }
    let script = material.child("script").and_then(|script| script.child("name"));
    let name = script.map_or_else(String::new, |name| format!(" name=\"{}\"", escaped(text_of(name.node))));
    let inside: String = material
        .node
        .children()
        .filter(roxmltree::Node::is_element)
        .map(|node| flat(reader, Part { node, file: material.file }))
        .collect();
    format!("<material{name}>{}{inside}</material>", diffuse.unwrap_or_default())
}
