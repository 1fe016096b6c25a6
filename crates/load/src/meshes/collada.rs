//! The triangles of a COLLADA file: what its scene shows, in metres.
//!
//! The file's unit is applied; its up axis is not, as robots' meshes stand in their link's frame as they are (RViz, the explorer).
//! Source: Khronos Group, "COLLADA - Digital Asset Schema Release 1.4.1".

use denavit_model::nalgebra::{Matrix4, Point3, Rotation3, Unit, Vector3};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashMap;

type Triangle = [Vector3<f64>; 3];

/// More triangles are refused.
const MOST: usize = 5_000_000;

/// Nodes in nodes in nodes: deeper is a circle.
const DEEPEST: usize = 64;

pub(super) fn triangles(bytes: &[u8]) -> Result<Vec<Triangle>, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "it is no UTF-8 text".to_owned())?;
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| error.to_string())?;
    let root = document.root_element();
    let unit = match element(root, "asset").and_then(|asset| element(asset, "unit")?.attribute("meter")) {
        Some(written) => written
            .parse::<f64>()
            .ok()
            .filter(|unit| unit.is_finite() && *unit > 0.0)
            .ok_or("its unit is not a number")?,
        None => 1.0,
    };
    let ids = root.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect();
    let mut scene = Scene { ids, found: Vec::new() };
    let shown = element(root, "scene").and_then(|shown| element(shown, "instance_visual_scene"));
    let shown = shown.and_then(|shown| scene.named(shown.attribute("url")));
    let shown =
        shown.or_else(|| element(root, "library_visual_scenes").and_then(|library| element(library, "visual_scene")));
    let scale = Matrix4::new_scaling(unit);
    match shown {
        Some(shown) => {
            for node in elements(shown, "node") {
                scene.node(node, scale, 0)?;
            }
        }
        None => {
            for geometry in root.descendants().filter(|node| node.tag_name().name() == "geometry") {
                scene.geometry(geometry, &scale)?;
            }
        }
    }
    Ok(scene.found)
}

struct Scene<'a, 'input> {
    ids: HashMap<&'a str, Node<'a, 'input>>,
    found: Vec<Triangle>,
}

fn elements<'a, 'input>(node: Node<'a, 'input>, tag: &'static str) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(move |child| child.tag_name().name() == tag)
}

fn element<'a, 'input>(node: Node<'a, 'input>, tag: &'static str) -> Option<Node<'a, 'input>> {
    elements(node, tag).next()
}

fn numbers(node: Node) -> Result<Vec<f64>, String> {
    let words = node.descendants().filter(Node::is_text).filter_map(|text| text.text()).flat_map(str::split_whitespace);
    let wrong = || format!("<{}> holds something that is not a number", node.tag_name().name());
    words.map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(wrong)).collect()
}

fn indices(node: Node) -> Result<Vec<usize>, String> {
    let words = node.text().unwrap_or_default().split_whitespace();
    words
        .map(|word| {
            word.parse().map_err(|_| format!("<{}> holds something that is not an index", node.tag_name().name()))
        })
        .collect()
}

impl<'a, 'input> Scene<'a, 'input> {
    fn named(&self, url: Option<&str>) -> Option<Node<'a, 'input>> {
        self.ids.get(url?.trim().trim_start_matches('#')).copied()
    }

    fn node(&mut self, node: Node<'a, 'input>, above: Matrix4<f64>, depth: usize) -> Result<(), String> {
        if depth > DEEPEST {
            return Err("its nodes form a loop".into());
        }
        let mut here = above;
        for part in node.children().filter(Node::is_element) {
            let tag = part.tag_name().name();
            let step = match tag {
                "matrix" | "translate" | "rotate" | "scale" => numbers(part)?,
                _ => continue,
            };
            here *= match (tag, &step[..]) {
                ("matrix", rows) if rows.len() == 16 => Matrix4::from_row_slice(rows),
                ("translate", [x, y, z]) => Matrix4::new_translation(&Vector3::new(*x, *y, *z)),
                ("scale", [x, y, z]) => Matrix4::new_nonuniform_scaling(&Vector3::new(*x, *y, *z)),
                ("rotate", [x, y, z, degrees]) => match Unit::try_new(Vector3::new(*x, *y, *z), 0.0) {
                    Some(axis) => Rotation3::from_axis_angle(&axis, degrees.to_radians()).to_homogeneous(),
                    None => return Err("a rotation has no axis".into()),
                },
                _ => return Err(format!("<{tag}> has {} numbers", step.len())),
            };
        }
        for part in node.children().filter(Node::is_element) {
            match part.tag_name().name() {
                "node" => self.node(part, here, depth + 1)?,
                "instance_node" => {
                    if let Some(other) = self.named(part.attribute("url")) {
                        self.node(other, here, depth + 1)?;
                    }
                }
                "instance_geometry" => {
                    if let Some(geometry) = self.named(part.attribute("url")) {
                        self.geometry(geometry, &here)?;
                    }
                }
                "instance_controller" => {
                    let skin = self.named(part.attribute("url")).and_then(|controller| element(controller, "skin"));
                    if let Some(geometry) = skin.and_then(|skin| self.named(skin.attribute("source"))) {
                        self.geometry(geometry, &here)?;
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn geometry(&mut self, geometry: Node<'a, 'input>, pose: &Matrix4<f64>) -> Result<(), String> {
        let Some(mesh) = element(geometry, "mesh") else { return Ok(()) };
        for part in mesh.children().filter(Node::is_element) {
            let tag = part.tag_name().name();
            if !["triangles", "polylist", "polygons", "trifans", "tristrips"].contains(&tag) {
                continue;
            }
            let offset = |input: &Node| input.attribute("offset").and_then(|written| written.parse::<usize>().ok());
            let stride = elements(part, "input").filter_map(|input| offset(&input)).max().map_or(1, |most| most + 1);
            let of_corners = elements(part, "input").find(|input| input.attribute("semantic") == Some("VERTEX"));
            let of_corners = of_corners.ok_or("a face has no corners")?;
            let at = offset(&of_corners).unwrap_or(0);
            let points = self.points(of_corners, pose)?;
            let mut polygons: Vec<Vec<usize>> = Vec::new();
            let lists = elements(part, "p").map(indices).collect::<Result<Vec<_>, String>>()?;
            let corners =
                lists.iter().map(|list| list.chunks_exact(stride).map(|corner| corner[at]).collect::<Vec<_>>());
            match tag {
                "triangles" => corners.for_each(|list| polygons.extend(list.chunks_exact(3).map(<[usize]>::to_vec))),
                "polylist" => {
                    let counts =
                        element(part, "vcount").map(indices).transpose()?.ok_or("a <polylist> has no <vcount>")?;
                    for list in corners {
                        let mut rest = &list[..];
                        for count in &counts {
                            let (own, after) =
                                rest.split_at_checked(*count).ok_or("a <vcount> needs more indices than there are")?;
                            polygons.push(own.to_vec());
                            rest = after;
                        }
                    }
                }
                // Every second triangle of a strip turns the other way.
                "tristrips" => corners.for_each(|list| {
                    let turned = |(index, own): (usize, &[usize])| {
                        if index % 2 == 0 { own.to_vec() } else { vec![own[1], own[0], own[2]] }
                    };
                    polygons.extend(list.windows(3).enumerate().map(turned));
                }),
                // A fan is a polygon cut from its first corner.
                _ => polygons.extend(corners),
            }
            for polygon in polygons {
                for index in 1..polygon.len().saturating_sub(1) {
                    let corner = |index: usize| {
                        points.get(polygon[index]).copied().ok_or("a face names a corner that does not exist")
                    };
                    self.found.push([corner(0)?, corner(index)?, corner(index + 1)?]);
                }
                if self.found.len() > MOST {
                    return Err("it has too many triangles".into());
                }
            }
        }
        Ok(())
    }

    fn points(&self, input: Node, pose: &Matrix4<f64>) -> Result<Vec<Vector3<f64>>, String> {
        let vertices = self.named(input.attribute("source")).ok_or("the corners of its faces are missing")?;
        let position = elements(vertices, "input").find(|input| input.attribute("semantic") == Some("POSITION"));
        let source =
            position.and_then(|input| self.named(input.attribute("source"))).ok_or("its points are missing")?;
        let array = element(source, "float_array").ok_or("its points have no numbers")?;
        let accessor = element(source, "technique_common").and_then(|common| element(common, "accessor"));
        let number =
            |name: &str| accessor.and_then(|of| of.attribute(name)).and_then(|word| word.parse::<usize>().ok());
        let (stride, offset) = (number("stride").unwrap_or(3).max(3), number("offset").unwrap_or(0));
        let numbers = numbers(array)?;
        let rows = numbers.get(offset..).unwrap_or_default().chunks_exact(stride);
        Ok(rows.map(|row| pose.transform_point(&Point3::new(row[0], row[1], row[2])).coords).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_read_with_its_units_and_poses() {
        let text = r##"<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
          <asset><unit name="mm" meter="0.001"/><up_axis>Z_UP</up_axis></asset>
          <library_geometries><geometry id="g"><mesh>
            <source id="p"><float_array id="a" count="12">0 0 0 1000 0 0 1000 1000 0 0 1000 0</float_array>
              <technique_common><accessor source="#a" count="4" stride="3"/></technique_common></source>
            <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
            <polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#n" offset="1"/>
              <vcount>4</vcount><p>0 0 1 0 2 0 3 0</p></polylist>
          </mesh></geometry></library_geometries>
          <library_visual_scenes><visual_scene id="s"><node><translate>0 0 500</translate><rotate>0 0 1 90</rotate>
            <instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
          <scene><instance_visual_scene url="#s"/></scene></COLLADA>"##;
        let found = triangles(text.as_bytes()).unwrap();
        assert_eq!(found.len(), 2);
        assert!((found[0][1] - Vector3::new(0.0, 1.0, 0.5)).norm() < 1e-12, "{found:?}");
        assert!((found[1][2] - Vector3::new(-1.0, 0.0, 0.5)).norm() < 1e-12, "{found:?}");
        assert!(triangles(b"<COLLADA><scene/></COLLADA>").unwrap().is_empty());
    }
}
