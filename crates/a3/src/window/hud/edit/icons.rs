//! Drawings on the buttons of the tools.

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, vec2};

use crate::window::session::Tool;

/// Draws the icon of a tool around a point, about 20 points wide.
pub fn draw(painter: &Painter, tool: Tool, at: Pos2, colour: Color32) {
    let stroke = Stroke::new(1.7, colour);
    let point = |x: f32, y: f32| at + vec2(x, y);
    let line = |points: &[[f32; 2]]| {
        let points = points.iter().map(|[x, y]| point(*x, *y)).collect();
        painter.add(Shape::line(points, stroke));
    };
    let dot = |x: f32, y: f32| painter.circle_filled(point(x, y), 2.8, colour);
    let cube = |x: f32, y: f32, side: f32| {
        let rect = Rect::from_center_size(point(x, y), vec2(side, side));
        painter.rect_stroke(rect, 1.5, stroke, StrokeKind::Middle);
    };
    match tool {
        Tool::ThrowBall | Tool::ThrowBox => {
            for (y, from) in [(-3.0, -9.0), (1.0, -11.0), (5.0, -8.0)] {
                line(&[[from, y], [-2.5, y - 1.0]]);
            }
            if tool == Tool::ThrowBall {
                painter.circle_stroke(point(5.0, 0.0), 5.2, stroke);
            } else {
                cube(5.0, 0.0, 9.4);
            }
        }
        Tool::AddBall | Tool::AddBox => {
            if tool == Tool::AddBall {
                painter.circle_stroke(point(0.0, 0.2), 5.2, stroke);
            } else {
                cube(0.0, 0.6, 9.4);
            }
            line(&[[-10.0, 7.4], [10.0, 7.4]]);
        }
        Tool::Particle => {
            painter.circle_filled(at, 3.8, colour);
        }
        Tool::Spring => {
            dot(-10.0, 0.0);
            dot(10.0, 0.0);
            let turns = (0..9).map(|k| {
                let y = match k {
                    0 | 8 => 0.0,
                    k if k % 2 == 0 => 4.4,
                    _ => -4.4,
                };
                [-8.0 + 2.0 * k as f32, y]
            });
            line(&turns.collect::<Vec<_>>());
        }
        Tool::Rod => {
            dot(-9.0, 4.0);
            dot(9.0, -4.0);
            line(&[[-9.0, 4.0], [9.0, -4.0]]);
        }
        Tool::Rope => {
            dot(-9.5, -4.0);
            dot(9.5, -4.0);
            let sag = (0..=12).map(|k| {
                let x = k as f32 / 6.0 - 1.0;
                [9.5 * x, 5.0 - 9.0 * x * x]
            });
            line(&sag.collect::<Vec<_>>());
        }
        Tool::Delete => {
            line(&[[-5.5, -5.5], [5.5, 5.5]]);
            line(&[[-5.5, 5.5], [5.5, -5.5]]);
        }
    }
}
